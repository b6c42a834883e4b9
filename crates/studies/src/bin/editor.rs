//! How long an editor waits for diagnostics, for every model of the gallery and of tests/bad: a character is typed and deleted at places all along the text.
//!
//! In: models/ and tests/bad. Out: a table for docs/editor.md on standard output, and the time of a thousand edits sent without waiting. Times are measured
//! from sending a change to receiving its diagnostics, through the whole server.

use std::error::Error;
use std::time::{Duration, Instant};

use lsp_server::{Connection, Message, Notification};
use serde_json::{Value, json};
use sidc_testing::program::{file, models};

const URI: &str = "file:///model.sid";

/// Places in a text where something is typed.
const PLACES: usize = 20;

/// An editor connected to a server.
struct Editor {
    connection: Connection,
    version: i32,
}

impl Editor {
    fn new() -> Result<Editor, Box<dyn Error>> {
        let (server, connection) = Connection::memory();
        std::thread::spawn(move || sidc_lsp::serve(&server, &()));
        let editor = Editor {
            connection,
            version: 0,
        };
        let encodings = json!({ "general": { "positionEncodings": ["utf-8"] } });
        let params = json!({ "capabilities": encodings });
        let request = lsp_server::Request::new(1.into(), "initialize".into(), params);
        editor.connection.sender.send(request.into())?;
        editor.connection.receiver.recv()?;
        editor.tell("initialized", json!({}))?;
        Ok(editor)
    }

    fn tell(&self, method: &str, params: Value) -> Result<(), Box<dyn Error>> {
        let message = Notification::new(method.into(), params);
        Ok(self.connection.sender.send(message.into())?)
    }

    fn open(&mut self, text: &str) -> Result<(), Box<dyn Error>> {
        self.version += 1;
        let item =
            json!({ "uri": URI, "languageId": "sid", "version": self.version, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": item }))?;
        self.wait();
        Ok(())
    }

    fn change(
        &mut self,
        line: usize,
        (start, end): (usize, usize),
        text: &str,
    ) -> Result<(), Box<dyn Error>> {
        self.version += 1;
        let at = |character: usize| json!({ "line": line, "character": character });
        let change = json!({ "range": { "start": at(start), "end": at(end) }, "text": text });
        let document = json!({ "uri": URI, "version": self.version });
        let params = json!({ "textDocument": document, "contentChanges": [change] });
        self.tell("textDocument/didChange", params)
    }

    /// Waits for the diagnostics of the current text.
    fn wait(&self) {
        while let Ok(message) = self.connection.receiver.recv() {
            let of_now = |n: &Notification| n.params["version"] == self.version;
            if matches!(&message, Message::Notification(n) if of_now(n)) {
                return;
            }
        }
    }
}

/// Times from a change to its diagnostics, at places all along a text.
fn times(text: &str) -> Result<Vec<Duration>, Box<dyn Error>> {
    let mut editor = Editor::new()?;
    editor.open(text)?;
    let mut times = Vec::new();
    let lines: Vec<&str> = text.lines().collect();
    for line in (0..lines.len()).step_by((lines.len() / PLACES).max(1)) {
        let end = lines[line].len();
        for (range, typed) in [((end, end), "x"), ((end, end + 1), "")] {
            let start = Instant::now();
            editor.change(line, range, typed)?;
            editor.wait();
            times.push(start.elapsed());
        }
    }
    Ok(times)
}

fn row(name: &str, times: &mut [Duration]) {
    times.sort();
    let ms = |t: Duration| 1e3 * t.as_secs_f64();
    let (median, worst) = (times[times.len() / 2], times[times.len() - 1]);
    println!(
        "| {name} | {} | {:.2} | {:.2} |",
        times.len(),
        ms(median),
        ms(worst)
    );
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("| texts | keystrokes | median ms | worst ms |\n|---|---|---|---|");
    let mut slowest = Vec::new();
    for (folder, label) in [("models", "the gallery"), ("tests/bad", "faulty models")] {
        let mut all = Vec::new();
        for (name, text) in models(folder) {
            let own = times(&text)?;
            let worst = own.iter().copied().max().unwrap_or_default();
            slowest.push((worst, name, own.clone()));
            all.extend(own);
        }
        row(label, &mut all);
    }
    slowest.sort();
    for (_, name, mut own) in slowest.into_iter().rev().take(3) {
        row(&name, &mut own);
    }
    let pendulum = file("models/pendulum.sid");
    let mut editor = Editor::new()?;
    editor.open(&pendulum)?;
    let start = Instant::now();
    for _ in 0..500 {
        editor.change(0, (0, 0), "#")?;
        editor.change(0, (0, 1), "")?;
    }
    editor.wait();
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "\n1,000 edits of pendulum.sid sent at once, to the diagnostics of the last: {seconds:.3} s"
    );
    Ok(())
}
