// The models of the gallery with their data, which comments in the models name.
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";

/** `{model, data}` for each `.sid` file in a folder, by name; the pendulum first. */
export function gallery(folder) {
  const models = readdirSync(folder).filter((name) => name.endsWith(".sid"));
  const first = (name) => (name === "pendulum.sid" ? "" : name);
  models.sort((a, b) => (first(a) < first(b) ? -1 : 1));
  return models.map((model) => {
    const text = readFileSync(join(folder, model), "utf8");
    const heads = [...text.matchAll(/^#.*$/gm)];
    const named = heads.flatMap(([line]) => [...line.matchAll(/models\/data\/(\w+\.csv)/g)]);
    return { model, data: [...new Set(named.map(([, name]) => name))] };
  });
}
