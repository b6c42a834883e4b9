//! Constants at which fewer terms suffice than at those where the search ended.
//!
//! In: the profile and its best point. Out: points with fewer terms.
//!
//! Terms of a family can stand for each other: `x` and `x/(1 + r/(1 + x^2/s^2))` together are the same curve for every r, with an s that
//! follows, and for one r a single term is enough. The profile has a valley along r, and its criterion drops only at exactly
//! that r, so the constants are fitted for each part of the terms.

use super::profile::{Profile, ProfilePoint};
use super::searched_constant::SearchedConstant;
use super::thresholds::UNKNOWNS;
use super::variable_projection::project;
use sidc_progress::Observer;
use sidc_solve::threads::{self, map_watched};

/// The best terms at the constants that fit a proper part of the best point's terms, for each such part.
pub(super) fn with_fewer_terms(
    profile: &Profile,
    best: &ProfilePoint,
    observer: &mut dyn Observer,
) -> Vec<ProfilePoint> {
    if profile.is_large() {
        // With a large library each point takes a basis pursuit, which would take too long.
        return Vec::new();
    }
    let mut all = Vec::new();
    for (place, support) in best.supports.iter().enumerate() {
        for part in parts(support) {
            let mut supports = best.supports.clone();
            supports[place] = part;
            let equation = &profile.equations[place];
            let mut signals = profile.sought.iter().map(SearchedConstant::signal);
            if !signals.any(|s| equation.holds(&supports[place], s)) {
                continue;
            }
            all.push(supports);
        }
    }
    let refined = |supports: Vec<Vec<usize>>, observer: &mut dyn Observer| {
        let refined = project(profile, &supports, &best.values)?;
        profile.at(&refined.values, observer)
    };
    let refined = map_watched(threads::available(), all, observer, refined);
    refined.into_iter().flatten().collect()
}

/// The proper parts of a support that is not too large, none empty.
fn parts(support: &[usize]) -> Vec<Vec<usize>> {
    if support.len() > UNKNOWNS.part_terms {
        return Vec::new();
    }
    let all = 1..(1_usize << support.len()).saturating_sub(1);
    let part = |mask: usize| {
        let kept = support.iter().enumerate();
        let kept = kept.filter(|(k, _)| mask >> k & 1 == 1);
        kept.map(|(_, slot)| *slot).collect()
    };
    all.map(part).collect()
}
