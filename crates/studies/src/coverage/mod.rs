//! How often intervals contain the truth: cases of known laws, draws of noise, and their figures.

pub mod accelerometer;
pub mod case;
pub mod driven;
pub mod figures;
pub mod filtered;
pub mod odebench;
pub mod pendulum;
pub mod run;
pub mod sampled_input;
