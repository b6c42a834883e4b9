//! The arguments of `sidc identify`, translated to options of the library.

use std::path::PathBuf;
use std::time::Duration;

use crate::failure::Failure;
use crate::monitoring::verbosity::Verbosity;
use crate::option_values::time_ranges::HeldOut;
use crate::option_values::{assignments, limits, names, quantities, time_ranges};
use crate::thresholds::MODEL_COMPARISON;
use sidc::pipeline;
use sidc::{HoldOutRange, Method, Options};
use sidc_discover::METHODS;
use sidc_lang::sensor_noise::SensorNoise;
use sidc_solve::SOLVERS;
use sidc_system::predict::ErrorLimit;

const EXAMPLES: &str = "Examples:
  sidc identify pendulum.sid data.csv -o R.json           find the equations, keep the evidence
  sidc identify pendulum.sid data.csv --holdout=25%       and run them on a quarter not used
  sidc identify pendulum.sid data.csv --horizon 0.5 --good 10%   is it good enough, on data not used?
  sidc identify a.sid b.sid data.csv                      several models, the best by data not used
  sidc identify pendulum.sid data.csv --noise theta=0.01  a sensor whose noise is known
  sidc identify pendulum.sid data.csv --evidence          everything that the data tell, and do not tell
  sidc identify big.sid data.csv --time-limit 5m -v       at most five minutes, with a word on each stage";

/// Find the equations of a model in data
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// A model (.sid) and one or more data files; several files are several trajectories, several models are candidates
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Write the result document here
    #[arg(short, long)]
    pub output: Option<PathBuf>,
    /// Print the result document instead of the equations
    #[arg(long)]
    pub json: bool,
    /// Use N random rows; the others test the result
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: Option<u32>,
    /// Seed of that draw
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Use only times A to B, ends optional: --window=2..10, --window=..5
    #[arg(long, value_name = "A..B", value_parser = time_ranges::window, allow_hyphen_values = true)]
    pub window: Option<(Option<f64>, Option<f64>)>,
    /// Find no equations from times A to B, the last part of every record, or a file, but run them there:
    /// --holdout=30..40, --holdout=25%, --holdout=test.csv
    #[arg(long, value_name = "A..B|P%|FILE", value_parser = time_ranges::held_out, allow_hyphen_values = true)]
    pub holdout: Vec<HeldOut>,
    /// How far ahead predictions are compared with data not used, in seconds (samples in discrete time); else the data decide
    #[arg(long, value_name = "T", value_parser = quantities::positive, allow_hyphen_values = true)]
    pub horizon: Option<f64>,
    /// Largest error of predictions that far ahead, in 90 % of the starts: of every signal a part of its spread, or of one in its
    /// unit: --good=10%, --good theta=0.02,x=0.1. The exit status then says whether that holds on data not used
    #[arg(long, value_name = "P%|theta=0.02", value_parser = limits::good, allow_hyphen_values = true)]
    pub good: Vec<Vec<ErrorLimit>>,
    /// Of several models, take the first whose run on data not used is at least as good as this, in dB: --until=-60
    #[arg(long, value_name = "DB", value_parser = quantities::decibels, allow_hyphen_values = true)]
    pub until: Option<f64>,
    /// What equations are found from: the likelihood of the readings, trajectory and equations together (joint), estimated
    /// derivatives (regression), integrals against test functions (weak), or what suits the data (auto)
    #[arg(long, value_parser = names::method, default_value = METHODS[0].0)]
    pub method: Method,
    /// Sparse solver (`sidc list` shows them)
    #[arg(long, value_parser = names::solver, default_value = SOLVERS[0].name())]
    pub solver: &'static str,
    /// Constant parameters: one value a trajectory, or one for all
    #[arg(long = "param", value_name = "m=0.3,0.5", value_parser = assignments::parameter)]
    pub params: Vec<(String, Vec<f64>)>,
    /// Noise of a signal: a standard deviation in units of the model, a share of the value, or both: theta=0.01, x=2%, x=0.01+2%
    #[arg(long = "noise", value_name = "theta=0.01", value_parser = assignments::noise)]
    pub noise: Vec<(String, SensorNoise)>,
    /// Stop after this time with what there is: 30, 30s, 5m, 1h
    #[arg(long, value_name = "TIME", value_parser = quantities::time)]
    pub time_limit: Option<Duration>,
    /// Most memory for all tables, for all libraries, and for the values of one: 500MB, 2GB (10^9 bytes), 2GiB (2^30)
    #[arg(long, value_name = "SIZE", value_parser = quantities::memory, default_value = quantities::MEMORY)]
    pub memory_limit: u64,
    /// Give readings more than five standard deviations from the trajectory no weight
    #[arg(long)]
    pub robust: bool,
    /// Show after each equation the answers for larger tolerances, from the first term on
    #[arg(long)]
    pub path: bool,
    /// Show all evidence: what the data tell apart, what they do not, and from which rows
    #[arg(long)]
    pub evidence: bool,
    /// Check every equation and its proof once more, by separate code in 106 bits
    #[arg(long)]
    pub verify: bool,
    /// Look for the fewest terms that fit within the tolerance, and prove that it takes no fewer; at most this time for all
    /// equations together
    #[arg(long, value_name = "TIME", value_parser = quantities::time, num_args = 0..=1, require_equals = true, default_missing_value = "60s")]
    pub prove_sparsest: Option<Duration>,
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// An option that has no effect together with the others.
struct WithoutEffect {
    /// Whether the given options are such a case.
    holds: bool,
    option: &'static str,
    why: &'static str,
    help: &'static str,
}

impl Args {
    /// Rejects options that would have no effect together with the others.
    ///
    /// # Errors
    /// All of them at once.
    pub fn check_effects(&self, models: usize) -> Result<(), Failure> {
        let (drawn, joint) = (self.samples.is_some(), self.method == Method::Joint);
        let trajectory = "equations and trajectory are estimated together from all readings";
        let cases = [
            WithoutEffect {
                holds: drawn && self.method == Method::Weak,
                option: "--samples",
                why: "integrals are taken over all rows",
                help: "shorten the record with --window, or leave out --method weak",
            },
            WithoutEffect {
                holds: drawn && joint,
                option: "--samples",
                why: trajectory,
                help: "leave out --method joint, or shorten the record with --window",
            },
            WithoutEffect {
                holds: self.path && joint,
                option: "--path",
                why: trajectory,
                help: "leave out --method joint",
            },
            WithoutEffect {
                holds: self.prove_sparsest.is_some() && (joint || self.method == Method::Weak),
                option: "--prove-sparsest",
                why: "only equations found from rows with a tolerance have a sparsest one",
                help: "leave out --method, or give --method regression",
            },
            WithoutEffect {
                holds: self.until.is_some() && models == 1,
                option: "--until",
                why: "it chooses among several models, and there is one",
                help: "give more models, or leave it out",
            },
        ];
        let mut failed = Failure::default();
        for WithoutEffect {
            option, why, help, ..
        } in cases.into_iter().filter(|c| c.holds)
        {
            failed.add(Failure::new(format!(
                "error[option-without-effect]: {option}: {why}\n  = help: {help}"
            )));
        }
        failed.or(())
    }

    /// Data files in reading order: those given, then those that are only held out.
    pub fn data_paths(&self, data: &[PathBuf]) -> Vec<PathBuf> {
        let mut paths = data.to_vec();
        for path in self.holdout.iter().filter_map(HeldOut::file) {
            if !paths.contains(path) {
                paths.push(path.clone());
            }
        }
        paths
    }

    /// The options for a search in the files at `paths`. With several models a part of every record is held out to compare them.
    ///
    /// # Errors
    /// None for values that were parsed.
    pub fn options(&self, paths: &[PathBuf], models: usize) -> Result<Options, Failure> {
        let mut options = Options::default()
            .method(self.method)
            .seed(self.seed)
            .memory(self.memory_limit)
            .solver(self.solver)
            .map_err(|e| Failure::new(e.to_string()))?;
        if let Some(rows) = self.samples {
            options = options.samples(rows as usize, self.seed);
        }
        if let Some((from, to)) = self.window {
            options = options.window(from, to);
        }
        if self.path {
            options = options.path();
        }
        if self.prove_sparsest.is_some() {
            options = options.prove_sparsest();
        }
        if self.robust {
            options = options.robust();
        }
        if let Some(ahead) = self.horizon {
            options = options.horizon(ahead);
        }
        for limit in self.good.iter().flatten() {
            options = match limit {
                ErrorLimit::Share(part) => options.good(*part),
                ErrorLimit::Signal(name, error) => options.good_signal(name, *error),
            };
        }
        for held_out in &self.holdout {
            options = match held_out {
                HeldOut::Stretch(stretch) => options.hold_out(*stretch),
                HeldOut::File(path) => match paths.iter().position(|p| p == path) {
                    Some(place) => options.hold_out_run(place),
                    None => options,
                },
            };
        }
        if models > 1 && self.holdout.is_empty() {
            options = options.hold_out(HoldOutRange::Last(MODEL_COMPARISON.held_out));
        }
        let all = self.evidence || self.json || self.output.is_some();
        Ok(match all {
            true => options,
            false => pipeline::without_ranks(options),
        })
    }
}
