//! Two ways to the same equations: which one was tried first, which one is given.
//!
//! In: two discoveries of one system. Out: the record of it in the evidence, and a notice. Never changes a term or a coefficient.

use super::{Discovery, MethodComparison, Notice, ReasonCode, SecondMethodReason};

impl Discovery {
    /// The codes of all doubts and failures, each once.
    pub fn doubt_codes(&self) -> Vec<ReasonCode> {
        let found = self.equations.iter().flat_map(|e| &e.reasons);
        let failed = self.failed.iter().flat_map(|f| &f.reasons);
        let mut codes: Vec<ReasonCode> = Vec::new();
        for reason in found.chain(failed) {
            if !codes.contains(&reason.code) {
                codes.push(reason.code.clone());
            }
        }
        codes
    }

    /// Records in the evidence of every equation that two ways were tried.
    pub fn record_ways(&mut self, ways: &MethodComparison) {
        for evidence in self.equations.iter_mut().flat_map(|e| &mut e.evidence) {
            evidence.methods = Some(Box::new(ways.clone()));
        }
    }

    /// What is to be said of equations that came from the second of two ways.
    pub fn other_way(&self) -> Option<Notice> {
        let mut evidence = self.equations.iter().filter_map(|e| e.evidence.as_ref());
        let ways = evidence.find_map(|e| e.methods.as_deref())?;
        let codes: Vec<&str> = ways.first_doubts.iter().map(ReasonCode::as_str).collect();
        let text = format!(
            "by {} of the measured rates the equations are doubted ({}); these are by the {} estimate without those rates, and pass",
            ways.first,
            codes.join(", "),
            ways.second
        );
        // Where no rate was measured, the joint estimate is the usual way.
        let rates_measured = ways.why == SecondMethodReason::MeasuredRates;
        (ways.given == ways.second && rates_measured).then(|| Notice::new("other-way", text))
    }
}
