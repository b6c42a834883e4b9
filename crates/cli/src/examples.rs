//! What each subcommand's `--help` shows by example.

pub const CHECK: &str = "Examples:
  sidc check pendulum.sid                       what the model means: equations, terms, units
  sidc check pendulum.sid data.csv              what is measured, what has to be estimated
  sidc check pendulum.sid --terms               every candidate term by name";

pub const IDENTIFY: &str = "Examples:
  sidc identify pendulum.sid data.csv -o R.json           find the equations, keep the evidence
  sidc identify pendulum.sid data.csv --holdout=25%       and run them on a quarter not used
  sidc identify a.sid b.sid data.csv                      several models, the best by data not used
  sidc identify pendulum.sid data.csv --noise theta=0.01  a sensor whose noise is known
  sidc identify pendulum.sid data.csv --evidence          everything that the data tell, and do not tell
  sidc identify big.sid data.csv --time-limit 5m -v       at most five minutes, with a word on each stage";

pub const SIMULATE: &str = "Examples:
  sidc simulate R.json data.csv                     run the equations, and compare
  sidc simulate R.json data.csv -o run.csv          keep the simulated signals
  sidc simulate R.json data.csv --window=10..20     from another row on
  sidc simulate R.json input.csv --start theta=0.1,dtheta=0";

pub const REPORT: &str = "Examples:
  sidc report R.json data.csv -o report.html        one page to look at, to print, to mail
  sidc report R.json new.csv -o new.html            held against data the equations have not seen";

pub const NEW: &str = "Examples:
  sidc new data.csv                       print a first model of the table
  sidc new data.csv -o model.sid          write it, then:
  sidc identify model.sid data.csv";

pub const SMOOTH: &str = "Examples:
  sidc smooth pendulum.sid data.csv -o smooth.csv         curves, derivatives, standard errors
  sidc smooth pendulum.sid data.csv --noise theta=0.01    with a noise that is known";

pub const FMT: &str = "Examples:
  sidc fmt pendulum.sid                   lay the model out, in place
  sidc fmt --check *.sid                  status 1 if one would change";

pub const EXPORT: &str = "Examples:
  sidc export R.json --to latex           equations for a paper
  sidc export R.json --to c -o model.h    code with Jacobians";

pub const LINEARIZE: &str = "Examples:
  sidc linearize R.json --at theta=pi                 A and B near upright
  sidc linearize R.json --at theta=pi/6,F=2 --json    the same as a document";

pub const LIST: &str = "Examples:
  sidc list                               generators, functions, solvers, targets";

pub const COMPLETIONS: &str = "Examples:
  sidc completions bash > ~/.local/share/bash-completion/completions/sidc
  sidc completions zsh > ~/.zfunc/_sidc
  sidc completions fish > ~/.config/fish/completions/sidc.fish
  sidc completions powershell >> $PROFILE";
