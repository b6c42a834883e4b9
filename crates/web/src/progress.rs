//! Progress in words, for a page.

use std::ops::ControlFlow;

use sidc::{Activity, Observer, Stage, Stop};
use wasm_bindgen::JsValue;

/// Calls a function of the page when the words for the current work change. It cannot end the work: the page does so by ending the worker.
pub struct Progress {
    targets: Vec<String>,
    place: usize,
    said: String,
    page: js_sys::Function,
}

impl Progress {
    /// `targets`: the left sides of the equations, in the model's order.
    pub fn new(targets: Vec<String>, page: js_sys::Function) -> Progress {
        Progress {
            targets,
            place: 0,
            said: String::new(),
            page,
        }
    }

    fn say(&mut self, words: String) {
        if words == self.said {
            return;
        }
        // An exception in the page's function must not affect the work.
        let _ = self.page.call1(&JsValue::NULL, &JsValue::from_str(&words));
        self.said = words;
    }

    fn stage(&self, stage: Stage) -> String {
        match self.targets.get(self.place) {
            Some(target) => format!("{target}: {}", stage.words()),
            None => stage.words().into(),
        }
    }
}

impl Observer for Progress {
    fn hear(&mut self, activity: Activity) -> ControlFlow<Stop> {
        match activity {
            Activity::Preparing { signal } => self.say(format!("preparing {signal}")),
            Activity::Equation { place, stage } => {
                self.place = place;
                self.say(self.stage(stage));
            }
            Activity::Stage(stage) => self.say(self.stage(stage)),
            Activity::Running { .. } => self.say("running the equations along the data".into()),
            _ => {}
        }
        ControlFlow::Continue(())
    }
}
