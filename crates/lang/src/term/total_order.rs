//! Total orders, hashes and fingerprints of terms, so that they can be sorted, merged and looked up.
//!
//! In: terms. Out: orders and hashes that are the same in every run. Numbers compare by `total_cmp` and hash by their bits: equal
//! means the same `f64`.

use std::cmp::Ordering;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

use crate::term::expr::{Atom, Factor, Term, Weighted};

impl Term {
    /// A 64-bit hash of the term. It adds up over products of coprime terms, so that a library can be searched for `t·a/b` without
    /// making that term.
    pub fn fingerprint(&self) -> u64 {
        self.0.iter().fold(0, |sum: u64, factor| {
            let mut hasher = Fnv(0xCBF2_9CE4_8422_2325);
            factor.hash(&mut hasher);
            sum.wrapping_add(hasher.finish())
        })
    }
}

impl Ord for Atom {
    fn cmp(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Atom::Signal(a), Atom::Signal(b)) => a.cmp(b),
            // Terms of one library share their factors, so most comparisons end at the pointer.
            (Atom::Call(f, a), Atom::Call(g, b)) => {
                f.cmp(g).then_with(|| match Arc::ptr_eq(a, b) {
                    true => Ordering::Equal,
                    false => a.cmp(b),
                })
            }
            (Atom::Sum(a), Atom::Sum(b)) if Arc::ptr_eq(a, b) => Ordering::Equal,
            (Atom::Sum(a), Atom::Sum(b)) => a.cmp(b),
            _ => self.rank().cmp(&other.rank()),
        }
    }
}

impl Ord for Factor {
    fn cmp(&self, other: &Self) -> Ordering {
        self.atom
            .cmp(&other.atom)
            .then_with(|| self.power.total_cmp(&other.power))
    }
}

impl Ord for Weighted {
    fn cmp(&self, other: &Self) -> Ordering {
        self.term
            .cmp(&other.term)
            .then_with(|| self.weight.total_cmp(&other.weight))
    }
}

/// A multiplicative hash in the manner of FNV-1a (Fowler, Noll, Vo 1991), on words: fast, and the same in every run.
struct Fnv(u64);

impl Hasher for Fnv {
    /// The finalizer of MurmurHash3 with the constants of Stafford's variant 13 (2011): every bit depends on every bit. Exponents differ
    /// in their top bits only, and sums of hashes that differ there would collide.
    fn finish(&self) -> u64 {
        let a = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let b = (a ^ (a >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        b ^ (b >> 31)
    }

    fn write(&mut self, bytes: &[u8]) {
        for b in bytes {
            self.write_u64(u64::from(*b));
        }
    }

    fn write_u8(&mut self, x: u8) {
        self.write_u64(u64::from(x));
    }

    fn write_u16(&mut self, x: u16) {
        self.write_u64(u64::from(x));
    }

    fn write_usize(&mut self, x: usize) {
        self.write_u64(x as u64);
    }

    fn write_u64(&mut self, x: u64) {
        let mixed = (self.0 ^ x).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = mixed ^ (mixed >> 29);
    }
}

impl Hash for Atom {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.rank().hash(state);
        match self {
            Atom::Signal(s) => s.hash(state),
            Atom::Call(f, args) => (f, args).hash(state),
            Atom::Sum(e) => e.hash(state),
        }
    }
}

impl Hash for Factor {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (&self.atom, self.power.to_bits()).hash(state);
    }
}

impl Hash for Weighted {
    fn hash<H: Hasher>(&self, state: &mut H) {
        (&self.term, self.weight.to_bits()).hash(state);
    }
}

macro_rules! order_by_cmp {
    ($($t:ty),*) => {$(
        impl PartialOrd for $t {
            fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
                Some(self.cmp(other))
            }
        }
        impl PartialEq for $t {
            fn eq(&self, other: &Self) -> bool {
                self.cmp(other) == Ordering::Equal
            }
        }
        impl Eq for $t {}
    )*};
}

order_by_cmp!(Atom, Factor, Weighted);
