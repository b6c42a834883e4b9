//! A corpus of names and texts that are code in some language, and a system that uses them all.

use sidc_system::discovery::Discovery;
use sidc_system::result;

/// Names that the language allows: keywords of every target, names in generated code, letters that look alike.
pub const NAMES: &[&str] = &[
    // Rust, C, Python, MATLAB, JavaScript.
    "type",
    "fn",
    "self",
    "Self",
    "crate",
    "dyn",
    "match",
    "async",
    "await",
    "gen",
    "union",
    "macro_rules",
    "r",
    "int",
    "double",
    "long",
    "static",
    "register",
    "restrict",
    "auto",
    "goto",
    "volatile",
    "printf",
    "main",
    "NULL",
    "M_PI",
    "NAN",
    "errno",
    "lambda",
    "class",
    "def",
    "None",
    "True",
    "import",
    "yield",
    "print",
    "np",
    "numpy",
    "math",
    "sp",
    "sympy",
    "array",
    "end",
    "function",
    "persistent",
    "global",
    "ans",
    "i",
    "j",
    "inf",
    "NaN",
    "eps",
    "zeros",
    "var",
    "let_",
    "undefined",
    // Names used in generated code.
    "rates",
    "jacobian",
    "jacobian_input",
    "outputs",
    "mass",
    "force",
    "right",
    "solve",
    "newton",
    "w1",
    "a",
    "b",
    "x_2",
    "out",
    "param",
    "history",
    "S",
    "N",
    "I",
    "Q",
    "O",
    "E",
    "C",
    "beta",
    "gamma",
    "Symbol",
    "Function",
    "e",
    // Letters beyond ASCII, and names that differ only by case or look alike.
    "θ",
    "Ω",
    "λ",
    "é",
    "ü_1",
    "名",
    "х",
    "ℝ",
    "𝑥",
    "ｘ",
    "ع",
    "אב",
    "ñandú",
    "ß",
    "X_",
    "x_",
    "ſ",
];

/// Hostile titles and texts.
pub const TEXTS: &[&str] = &[
    "*/ int main(void) { return 1; } /*",
    "\"\"\"\nimport os\n'''",
    "\\input{/etc/passwd} \\end{document} % $ & # _ { } ~ ^",
    "<script>alert(1)</script><img src=x onerror=alert(1)>",
    "\" onload=\"alert(1)\" x='",
    "--> ]]> <!-- <![CDATA[ &lt; &#60;",
    "%{\nblock\n%}",
    "\u{202e}gnirts\u{202c} \u{200b}\u{feff} a\u{301}\u{302}\u{303}",
    "\u{1b}[2J\u{1b}]0;title\u{7} \t \u{9b}31m",
    "\u{0} \r\n\t",
    "#![no_std] #include <none.h>",
    "{}}{{ {0} %s %n ${x} `rm -rf` $(date)",
    "🙂 👩‍👩‍👧 ﷽",
];

/// A system whose signals have all these names and whose title contains all these texts.
pub fn system() -> Discovery {
    let long = "n".repeat(300);
    let (longer, other) = (format!("{long}a"), format!("{long}b"));
    let names: Vec<&str> = NAMES
        .iter()
        .copied()
        .chain([longer.as_str(), other.as_str()])
        .collect();
    let variables = names
        .iter()
        .map(|n| serde_json::json!({"name": n, "kind": "state", "order": 1}));
    let equations = names.iter().enumerate().map(|(k, n)| {
        let next = names[(k + 1) % names.len()];
        let terms = [(n.to_string(), -0.5), (format!("sin({next})"), 0.25)];
        let terms = terms.map(|(t, c)| serde_json::json!({"term": t, "coefficient": c}));
        serde_json::json!({"target": format!("d{n}"), "terms": terms, "status": "pass"})
    });
    let document = serde_json::json!({
        "sidc_result": 1, "time": "continuous",
        "variables": variables.collect::<Vec<_>>(), "equations": equations.collect::<Vec<_>>(),
    });
    let read = result::read("R.json", &document.to_string());
    let mut system = read.unwrap_or_else(|d| panic!("{}", d.message));
    system.system = Some(TEXTS.join(" "));
    system
}
