// The models of the gallery with their data.

/** Models whose data have another name: models/README.md. */
const DATA = {
  pendulum_768: ["pendulum"],
  pendulum_symmetry: ["pendulum"],
  sir: ["sir_a", "sir_b"],
  michaelis_menten_unknown: ["michaelis_menten"],
  forced_frequency: ["forced_pendulum"],
};

/** `{model, data}` for each `.sid` among the names of files, by name; the pendulum first. */
export function gallery(files) {
  const models = files.filter((name) => name.endsWith(".sid")).map((name) => name.slice(0, -4));
  const first = (name) => (name === "pendulum" ? "" : name);
  models.sort((a, b) => (first(a) < first(b) ? -1 : 1));
  return models.map((name) => ({
    model: `${name}.sid`,
    data: (DATA[name] ?? [name]).map((data) => `${data}.csv`),
  }));
}
