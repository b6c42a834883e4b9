//! How much a command prints on standard error, as the user requested.

/// How much is printed on stderr.
#[derive(clap::Args)]
pub struct Verbosity {
    /// Only warnings and errors on stderr
    #[arg(short, long)]
    pub quiet: bool,
    /// Say on stderr what is done and how long each stage takes
    #[arg(short, long, conflicts_with = "quiet")]
    pub verbose: bool,
}

impl Verbosity {
    pub fn notes(&self) -> Notes {
        match self.quiet {
            true => Notes::None,
            false => Notes::Lines,
        }
    }
}

/// How much of the notes is printed. `check` prints them in full; `identify` is about the equations.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Notes {
    Full,
    /// One line each, without excerpts.
    Lines,
    None,
}
