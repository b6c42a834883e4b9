//! `sidc lsp` in Neovim, with the plugin of editors/neovim. The protocol itself is tested in crates/lsp.

mod trees;

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::{Value, json};
use sidc_testing::program::{binary, file, root, sidc};
use sidc_testing::runtimes::neovim;

/// Runs one job of neovim.lua on a model. Returns its answer.
fn in_neovim(neovim: &Path, job: &str, model: &Path, steps: &Value) -> Value {
    let run = Command::new(neovim)
        .args(["--headless", "--clean", "-n", "--cmd"])
        .arg("set runtimepath^=editors/neovim")
        .arg("--cmd")
        .arg(format!("let g:sidc_path = '{}'", binary().display()))
        .args(["-c", "luafile tests/it/editor/neovim.lua"])
        .env("SIDC_JOB", job)
        .env("SIDC_MODEL", model)
        .env("SIDC_STEPS", steps.to_string())
        .current_dir(root())
        .output()
        .unwrap();
    let shown = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{job} {}: {shown}", model.display());
    let line = String::from_utf8_lossy(&run.stdout);
    let line = line.lines().find(|l| l.starts_with('{'));
    serde_json::from_str(line.unwrap_or_else(|| panic!("{shown}"))).unwrap()
}

/// Sorted codes of what `sidc check` finds in a file.
fn codes(model: &str) -> Vec<String> {
    let shown = sidc(&["check", model]).stderr;
    let code = |line: &str| {
        let kinds = ["error[", "warning[", "note["];
        let rest = kinds.iter().find_map(|k| line.strip_prefix(k))?;
        Some(rest.split_once(']')?.0.to_string())
    };
    let mut codes: Vec<String> = shown.lines().filter_map(code).collect();
    codes.sort();
    codes
}

#[test]
fn neovim_shows_what_the_program_finds() {
    let Some(neovim) = neovim() else { return };
    let models = [
        "models/pendulum.sid",
        "models/narx.sid",
        "models/rlc.sid",
        "tests/bad/forms.sid",
        "tests/bad/pasted_signs.sid",
    ];
    for model in models.into_iter().filter(|m| root().join(m).exists()) {
        let answer = in_neovim(&neovim, "read", &root().join(model), &json!([]));
        assert_eq!(answer["found"], json!(codes(model)), "{model}");
        if model.starts_with("models/") {
            assert!(answer["symbols"].as_u64().unwrap() > 2, "{model}");
            let text = answer["text"].as_str().unwrap();
            assert_eq!(text, file(model).trim_end(), "the gallery is laid out");
        }
    }
}

#[test]
fn neovim_renames_and_mends() {
    let Some(neovim) = neovim() else { return };
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("pendulum θ.sid");
    fs::write(&model, file("models/pendulum.sid")).unwrap();
    let answer = in_neovim(&neovim, "change", &model, &json!([]));
    assert_eq!(answer["line"], 17, "the line that declares theta, from 0");
    assert_eq!(answer["renamed"], json!(codes("models/pendulum.sid")));
    assert_eq!(answer["broken"], json!(["unknown-statement"]));
    assert_eq!(answer["title"], "replace `symetry` by `symmetry`");
    let text = answer["text"].as_str().unwrap();
    assert!(text.contains("ddy, ddphi ~ everything") && text.contains("dphi, ddphi, sin phi"));
    assert!(!answer["mended"].to_string().contains("unknown-statement"));
}

/// Types a model by completion from an empty file: names are invented, everything else is chosen.
#[test]
fn neovim_types_a_model_by_completion() {
    let Some(neovim) = neovim() else { return };
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("new.sid");
    fs::write(
        folder.path().join("data.csv"),
        "Time (ms),Pos [mm],theta\n0,1,2\n",
    )
    .unwrap();
    let steps = json!([
        ["sidc", []],
        ["state", ["y, theta", "2"]],
        ["input", ["F", "hold"]],
        ["data", ["y", "|"]],
        ["Pos [mm]", [], true],
        ["let", ["trig", "<1, |>"]],
        ["sin", ["theta"], true],
        ["ddy ~", ["|"]],
        ["poly", ["y, dy, theta, dtheta, F", "2"], true],
        ["ddtheta ~", ["|"]],
        ["trig", [], true],
    ]);
    let answer = in_neovim(&neovim, "type", &model, &steps);
    assert_eq!(answer["found"], json!([]));
    let text = "sidc 1\nstate y, theta : order 2\ninput F : hold\ndata {\n  y = \"Pos [mm]\"\n}\nlet trig = <1, sin(theta)>\n\
                ddy ~ poly(y, dy, theta, dtheta, F; 2)\nddtheta ~ trig";
    assert_eq!(answer["text"], text);
}

/// A client that disconnects or sends nonsense ends the server with a status that says so.
#[test]
fn the_server_ends_with_its_client() {
    for (said, status) in [
        ("", 1),
        ("Content-Length: 9\r\n\r\nnonsense!", 1),
        ("no header\r\n\r\n", 1),
    ] {
        let mut server = Command::new(binary())
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        server
            .stdin
            .take()
            .unwrap()
            .write_all(said.as_bytes())
            .unwrap();
        let done = server.wait_with_output().unwrap();
        let shown = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(status), "{said:?}: {shown}");
        assert!(shown.starts_with("error[protocol]: "), "{said:?}: {shown}");
    }
}

/// Of a burst of changes, all in the pipe before the first is read, the last is analysed and few of the others.
#[test]
fn the_program_understands_the_last_of_many_changes() {
    const CHANGES: usize = 1_000;
    let text = file("models/double_pendulum.sid");
    let end = text.lines().count();
    let document =
        json!({ "uri": "file:///m.sid", "languageId": "sid", "version": 0, "text": text });
    let mut said = vec![
        json!({ "id": 1, "method": "initialize", "params": { "capabilities": {} } }),
        json!({ "method": "initialized", "params": {} }),
        json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } }),
    ];
    said.extend((1..=CHANGES).map(|version| {
        let place = json!({ "line": end, "character": version - 1 });
        let change = json!({ "range": { "start": place, "end": place }, "text": "#" });
        let document = json!({ "uri": "file:///m.sid", "version": version });
        json!({ "method": "textDocument/didChange", "params": { "textDocument": document, "contentChanges": [change] } })
    }));
    let framed = |message: &Value| {
        let mut message = message.clone();
        message["jsonrpc"] = json!("2.0");
        let body = message.to_string();
        format!("Content-Length: {}\r\n\r\n{body}", body.len())
    };
    let all: String = said.iter().map(framed).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("said");
    fs::write(&path, all).unwrap();
    let done = Command::new(binary())
        .arg("lsp")
        .stdin(fs::File::open(&path).unwrap())
        .output()
        .unwrap();
    let heard = String::from_utf8(done.stdout).unwrap();
    let answers = heard.matches("publishDiagnostics").count();
    assert!(heard.contains("\"version\":1000"), "{answers} answers");
    assert!(answers < CHANGES / 2, "{answers} answers");
}
