//! Why a command failed.
//!
//! In: messages. Out: all of them, on standard error.

/// A failure of the whole command: one or more messages.
#[derive(Default)]
pub struct Failure(Vec<String>);

impl Failure {
    pub fn new(text: impl Into<String>) -> Self {
        Failure(vec![text.into()])
    }

    /// A bug in the program.
    pub fn internal(error: impl std::fmt::Display) -> Self {
        Failure::new(format!("error[internal]: {error}; please report this"))
    }

    /// Adds the messages of another failure.
    pub fn add(&mut self, other: Failure) {
        self.0.extend(other.0);
    }

    /// The value, if there are no messages.
    ///
    /// # Errors
    /// The failure itself.
    pub fn or<T>(self, value: T) -> Result<T, Failure> {
        if self.0.is_empty() {
            Ok(value)
        } else {
            Err(self)
        }
    }

    pub fn print(&self) {
        for text in &self.0 {
            eprint!("{text}");
            if !text.ends_with('\n') {
                eprintln!();
            }
        }
    }
}
