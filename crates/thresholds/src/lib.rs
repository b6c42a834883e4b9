//! Numbers that decide: thresholds of verdicts, budgets of searches, parameters of methods.
//!
//! Related numbers form a family: one record, declared by [`family!`] with a name, a value, a unit and a source for each. The tables in docs/thresholds.md
//! are generated from these records. Depends on no other crate.
//!
//! A build with `RUSTFLAGS="--cfg vary_thresholds"` reads a factor for one number from the environment (`vary.rs`), with which the study `thresholds`
//! measures how far each number can be changed before an answer changes. In all other builds the numbers are constants.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

#[cfg(vary_thresholds)]
pub mod vary;

/// One number of a family, as the documentation prints it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Threshold {
    pub name: &'static str,
    /// What it decides.
    pub meaning: String,
    pub value: String,
    /// Empty for a pure number.
    pub unit: &'static str,
    /// A publication, a derivation, or the command of an experiment that reproduces it.
    pub source: &'static str,
}

/// A family with all its numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    pub name: &'static str,
    pub about: String,
    pub thresholds: Vec<Threshold>,
}

/// Declares a record of numbers and the constant that holds them.
///
/// ```
/// sidc_thresholds::family! {
///     /// When a fit counts as poor.
///     pub MISFIT: Misfit {
///         /// Residual from which an exact equation is doubted.
///         residual: f64 = 1e-4, unit "of the target's rms", source "by hand";
///         /// Fewest rows that are judged.
///         rows: usize = 10, unit "rows", source "by hand";
///     }
/// }
/// assert_eq!(MISFIT.rows, 10);
/// assert_eq!(Misfit::table().thresholds[0].value, "0.0001");
/// ```
#[macro_export]
macro_rules! family {
    (
        $(#[doc = $about:literal])+
        $vis:vis $constant:ident: $family:ident {
            $(
                $(#[doc = $meaning:literal])+
                $name:ident: $type:ty = $value:expr, unit $unit:literal, source $source:literal;
            )+
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Copy, Debug)]
        $vis struct $family {
            $(
                $(#[doc = $meaning])+
                #[doc = concat!("\nUnit: ", $unit, ". Source: ", $source)]
                pub $name: $type,
            )+
        }

        $(#[doc = $about])+
        #[cfg(not(vary_thresholds))]
        $vis const $constant: $family = $family { $($name: $value),+ };
        $(#[doc = $about])+
        #[cfg(vary_thresholds)]
        $vis static $constant: std::sync::LazyLock<$family> = std::sync::LazyLock::new(|| {
            $crate::vary::record_read(stringify!($family));
            $family {
                $($name: $crate::vary::varied(stringify!($family), stringify!($name), $value)),+
            }
        });

        impl $family {
            /// The numbers of the family, for the documentation.
            $vis fn table() -> $crate::Table {
                $crate::Table {
                    name: stringify!($family),
                    about: $crate::sentence(&[$($about),+]),
                    thresholds: vec![$($crate::Threshold {
                        name: stringify!($name),
                        meaning: $crate::sentence(&[$($meaning),+]),
                        value: format!("{:?}", $constant.$name),
                        unit: $unit,
                        source: $source,
                    }),+],
                }
            }
        }
    };
}

/// Lines of a doc comment as one line of text.
pub fn sentence(lines: &[&str]) -> String {
    let lines: Vec<&str> = lines.iter().map(|l| l.trim()).collect();
    lines.join(" ")
}

impl Table {
    /// The family as a section of Markdown. `moved` gives the study's result for a number.
    pub fn markdown(&self, moved: impl Fn(&Threshold) -> String) -> String {
        let mut out = format!(
            "## {}\n\n{}\n\n| name | value | unit | decides | × ½, × 2 | source |\n|---|---|---|---|---|---|\n",
            self.name, self.about
        );
        let cell = |text: &str| text.replace('|', "\\|");
        for t in &self.thresholds {
            let (unit, meaning, source) = (cell(t.unit), cell(&t.meaning), cell(t.source));
            let (name, value, moved) = (t.name, &t.value, moved(t));
            out.push_str(&format!(
                "| `{name}` | {value} | {unit} | {meaning} | {moved} | {source} |\n"
            ));
        }
        out
    }
}

#[cfg(test)]
mod tests {
    family! {
        /// Two
        /// lines.
        SAMPLE: Sample {
            /// The |φᵀλ| of a tie.
            tie: f64 = 0.5, unit "", source "by definition";
        }
    }

    #[test]
    fn a_family_is_a_record_and_a_table() {
        assert_eq!(SAMPLE.tie, 0.5);
        let text = Sample::table().markdown(|_| "0, 1 of 2".into());
        assert!(text.starts_with("## Sample\n\nTwo lines.\n"), "{text}");
        assert!(
            text.ends_with(
                "| `tie` | 0.5 |  | The \\|φᵀλ\\| of a tie. | 0, 1 of 2 | by definition |\n"
            ),
            "{text}"
        );
    }
}
