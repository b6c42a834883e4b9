//! Libraries kept as products, compared with the same sets written out term by term.
//!
//! Promises: the same terms, each once, and the same numbers of them; look-up finds every candidate at its slot, and nothing else; the
//! program refuses what the language does not allow, and nothing else.

use std::collections::BTreeSet;

use super::bytes::Bytes;
use super::set::{DECLARED, Set, TARGET, Wrong};
use sidc::pipeline;
use sidc::pipeline::MEMORY;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::library::Library;
use sidc_lang::render;
use sidc_lang::source::Sources;
use sidc_lang::term::{Parity, Signal, Term, VarId};

/// Refusals that the naive side does not foresee: terms that an identity ties to the target, and sets of too many parts.
const OTHER: [&str; 2] = ["target-by-identity", "library-too-large"];

pub fn algebra(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let rule = Rule::of(&mut bytes);
    let set = Set::of(&mut bytes);
    let written = match set.terms() {
        Err(Wrong::Large) => return,
        written => written,
    };
    let text = format!("{DECLARED}{}dx ~ {}\n", rule.text(), set.text());
    let mut sources = Sources::default();
    let file = sources.add("fuzz.sid", text.as_str());
    let (program, found) = pipeline::compile(file, &sources, MEMORY);
    let errors: Vec<&Diagnostic> = found.iter().filter(|d| d.is_error()).collect();
    if errors.iter().any(|d| OTHER.contains(&d.code)) {
        return;
    }
    let wanted = written.map(|mut all| {
        all.remove(&Term::signal(TARGET));
        let kept: BTreeSet<Term> = all.iter().filter(|t| rule.admits(t)).cloned().collect();
        (all, kept)
    });
    let shown = || format!("{text}{}", render(&found, &sources, false));
    match (program, wanted) {
        (Some(program), Ok((all, kept))) => {
            let library = program.libraries[0].as_ref().expect("a library");
            is_same(library, &all, &kept, &shown);
        }
        (None, Ok((_, kept))) => assert!(
            kept.is_empty(),
            "{} terms were refused:\n{}",
            kept.len(),
            shown()
        ),
        (Some(_), Err(_)) => panic!("accepted:\n{}", shown()),
        (None, Err(_)) => {}
    }
}

fn is_same(
    library: &Library,
    all: &BTreeSet<Term>,
    kept: &BTreeSet<Term>,
    shown: &dyn Fn() -> String,
) {
    let mut made = BTreeSet::new();
    for (slot, term) in library.terms() {
        assert_eq!(library.term(slot).as_ref(), Some(&term), "{}", shown());
        assert_eq!(library.contains(&term), Some(slot), "{}", shown());
        assert!(made.insert(term), "a term stands twice:\n{}", shown());
    }
    let (missing, surplus) = (kept.difference(&made).next(), made.difference(kept).next());
    assert!(
        missing.is_none() && surplus.is_none(),
        "{missing:?} is missing, {surplus:?} too many:\n{}",
        shown()
    );
    assert_eq!(library.len(), kept.len(), "{}", shown());
    if let Some(before) = library.before() {
        assert_eq!(before, all.len() as u128, "{}", shown());
    }
    let stranger = Term::signal(Signal::new(VarId(4))).pow(77.0);
    for term in all
        .difference(kept)
        .chain([&Term::signal(TARGET), &stranger])
    {
        assert_eq!(library.contains(term), None, "{}", shown());
    }
}

/// Symmetry and limit of degree, judged term by term.
struct Rule {
    flipped: Option<VarId>,
    degree: Option<u8>,
}

impl Rule {
    fn of(bytes: &mut Bytes) -> Rule {
        Rule {
            flipped: bytes.rarely(4).then(|| VarId(bytes.within(1, 3) as u16)),
            degree: bytes.rarely(4).then(|| bytes.within(1, 6) as u8),
        }
    }

    fn text(&self) -> String {
        let name = |v: VarId| super::set::NAMES[usize::from(v.0) - 1];
        let symmetry = self
            .flipped
            .map(|v| format!("symmetry {0} -> -{0}\n", name(v)));
        let limit = self.degree.map(|d| format!("limit degree {d}\n"));
        symmetry.unwrap_or_default() + &limit.unwrap_or_default()
    }

    fn admits(&self, term: &Term) -> bool {
        let flips = |s: Signal| Some(s.var) == self.flipped;
        let parity = match self.flipped {
            Some(_) => {
                let own = term.parity(&flips);
                own != Parity::Neither && own == Term::signal(TARGET).parity(&flips)
            }
            None => true,
        };
        parity
            && self
                .degree
                .is_none_or(|d| term.degree() <= f64::from(d) + 1e-9)
    }
}
