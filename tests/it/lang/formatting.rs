//! The formatter changes only white space, and formatting twice changes nothing more.
//!
//! Meanings are compared as abstract syntax trees without positions.

use sidc_lang::source::FileId;
use sidc_lang::{format, parse};

use super::texts_in;

fn formatted(text: &str) -> String {
    format(FileId(0), text).unwrap_or_else(|e| panic!("{text}\n{e:#?}"))
}

/// The abstract syntax tree without positions.
fn shape(text: &str) -> String {
    let (file, errors) = parse(FileId(0), text);
    assert!(errors.is_empty(), "{text}\n{errors:#?}");
    let shown = format!("{:?}", file.statements);
    let mut out = String::new();
    let mut rest = shown.as_str();
    while let Some(at) = rest.find("Span {") {
        out.push_str(&rest[..at]);
        rest = &rest[at + rest[at..].find('}').unwrap() + 1..];
    }
    out + rest
}

/// Everything except blanks, so that comments are compared too.
fn ink(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).collect()
}

pub fn check(text: &str) {
    let once = formatted(text);
    assert_eq!(ink(&once), ink(text), "something was lost or added");
    assert_eq!(
        shape(&once),
        shape(text),
        "the meaning changed:\n{text}\n---\n{once}"
    );
    assert_eq!(formatted(&once), once, "not a fixed point:\n{text}");
}

#[test]
fn texts_keep_their_meaning() {
    for folder in ["models", "tests/bad"] {
        for (_, text) in texts_in(folder) {
            if parse(FileId(0), &text).1.is_empty() {
                check(&text);
            }
        }
    }
}

#[test]
fn one_layout() {
    let untidy = "\n\nstate  x,y:order 2 , noise 1e-3 # two\n\n\n\ndata{\nt=\"Time\"*1e-3 ;x= -\"a-b\"\n  ddy =none\n}\nlet b=< x-1,\n-y >\n  # why\n*<dx ^ 2 / 3>\nddx~b\nddy  ~ poly( x ;1 .. 3 )+sin ( x )* 2\nconstrain coef(ddx,x)>-1\n";
    let tidy = r#"state x, y : order 2, noise 1e-3  # two

data {
  t   = "Time"*1e-3; x = -"a-b"
  ddy = none
}
let b = <x - 1,
    -y>
    # why
    * <dx^2 / 3>
ddx ~ b
ddy ~ poly(x; 1..3) + sin(x) * 2
constrain coef(ddx, x) > -1
"#;
    assert_eq!(formatted(untidy), tidy);
    check(untidy);
}

#[test]
fn relations_stand_below_each_other() {
    let untidy = "state x,y,z: order 1\ndx ,dy~x\ndz~<1-x,y>\n";
    let tidy = "state x, y, z : order 1\ndx, dy ~ x\ndz     ~ <1 - x, y>\n";
    assert_eq!(formatted(untidy), tidy);
    check(untidy);
}

#[test]
fn what_goes_on_stands_further_in() {
    let untidy = "state x,y : order  2\ndata {\nx = (\"a\"\n*2)-\"b\"\n+ ( \"c\" ) ^2\n dx= unwrap( \"d\",2*pi )\n- \"e\" *3\n}\nddx ~ <x, \n -(y) >*sin(x)\nddy = - 2 *x - (x+y)\nconstrain coef(ddx,x)>=\n0\n";
    let tidy = r#"state x, y : order 2
data {
  x  = ("a"
      * 2) - "b"
      + ("c")^2
  dx = unwrap("d", 2*pi)
      - "e" * 3
}
ddx ~ <x,
    -(y)>*sin(x)
ddy = -2 * x - (x + y)
constrain coef(ddx, x) >=
    0
"#;
    assert_eq!(formatted(untidy), tidy);
    check(untidy);
}

#[test]
fn a_wrong_text_is_not_formatted() {
    assert!(format(FileId(0), "dx ~ poly(x; 2").is_err());
}

/// Signs next to quotes keep the author's spacing, whatever the quotes contain.
#[test]
fn columns_keep_their_signs() {
    let entry = |source: &str| format!("state x\ndata {{ x = {source} }}\ndx ~ poly(x; 3)\n");
    for tidy in [
        "2*\"A\"",
        "2 * \"A\"",
        "\"A\"*2",
        "\"A\" * 2",
        "\"A\"/\"B\"",
        "\"A\" - \"B\" + 1",
        "-\"A\"",
        "2 - -\"A\"",
        "(\"A\" + \"-\")^2",
        "\"A\"^2",
        "unwrap(\"<\", 2*pi)",
        "\"*\" + \"/\"*\"+\"",
    ] {
        assert_eq!(formatted(&entry(tidy)), entry(tidy));
    }
    assert_eq!(
        formatted(&entry("( \"A\"+\"B\" )-\"C\" ^ 2")),
        entry("(\"A\" + \"B\") - \"C\"^2")
    );
}
