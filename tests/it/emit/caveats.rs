//! Every export states doubts and delays, in its first comment and as constants that compile.

use std::fs;
use std::process::Command;

use super::fmi::readable;
use sidc_emit as emit;
use sidc_system::discovery::{Discovery, Evidence, InputDelay, JointEvidence};
use sidc_system::result;
use sidc_testing::program::sidc;
use sidc_testing::runtimes;
use sidc_testing::runtimes::finished;

/// Text that would end a comment or a string in some language.
const HOSTILE: &str = "missed */ by \"\"\" 'far' \\end{x} %} //\n\u{7} ??/ `$(x)`";

/// ẋ = −x + 3 u(t − 0.25) with a doubt, or a law that passes, without a delay.
fn text(doubted: bool) -> String {
    let delay = InputDelay {
        input: "u".into(),
        seconds: 0.25,
        samples: 2.5,
    };
    let evidence = Evidence {
        joint: Some(JointEvidence {
            delays: if doubted { vec![delay] } else { Vec::new() },
            ..JointEvidence::default()
        }),
        ..Evidence::default()
    };
    let reasons = serde_json::json!([{"code": "misfit", "text": HOSTILE}]);
    let mut equation = serde_json::json!({"target": "dx", "status": "pass", "evidence": evidence,
        "terms": [{"term": "x", "coefficient": -1.0}, {"term": "u", "coefficient": 3.0}]});
    if doubted {
        equation["status"] = "doubt".into();
        equation["reasons"] = reasons;
    }
    serde_json::json!({"sidc_result": 1, "time": "continuous", "equations": [equation], "variables": [
        {"name": "x", "kind": "state", "order": 1}, {"name": "w", "kind": "input", "order": 0},
        {"name": "u", "kind": "input", "order": 0}]})
    .to_string()
}

fn late() -> Discovery {
    result::read("R.json", &text(true)).unwrap_or_else(|d| panic!("{}", d.message))
}

fn exported(target: &str) -> String {
    emit::target(target)
        .unwrap()
        .emit(&late())
        .unwrap()
        .into_text()
        .unwrap()
}

#[test]
fn every_target_names_the_doubt_and_the_delay() {
    for target in emit::TARGETS {
        let code = readable(target.emit(&late()).unwrap());
        let (name, head) = (target.name(), code.split("derivatives(t").next().unwrap());
        assert!(head.contains("verdict: doubted"), "{name}\n{code}");
        assert!(head.contains("dx: misfit: missed"), "{name}\n{code}");
        assert!(head.contains("u acts 0.25 s later"), "{name}\n{code}");
        if name != "text" {
            assert!(code.contains("doubted: dx misfit"), "{name}\n{code}");
        }
        let passed =
            result::read("R.json", &text(false)).unwrap_or_else(|d| panic!("{}", d.message));
        let passed = readable(target.emit(&passed).unwrap());
        assert!(
            passed.contains("verdict: passes") && !passed.contains("later than"),
            "{name}"
        );
        assert!(!passed.contains("SIDC_INPUT_DELAYS"), "{name}\n{passed}");
    }
}

#[test]
fn the_constants_compile_and_say_what_the_result_says() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let rust = format!(
        "{}\nfn main() {{ println!(\"{{}} {{:?}}\", SIDC_VERDICT, SIDC_INPUT_DELAYS); }}\n",
        exported("rust")
    );
    fs::write(at("r.rs"), rust).unwrap();
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let args = ["--edition", "2021", "-A", "dead_code", "-o"];
    finished(Command::new(rustc).args(args).arg(at("r")).arg(at("r.rs")));
    assert_eq!(
        finished(&mut Command::new(at("r"))),
        "doubted: dx misfit [0.25]\n"
    );
    if let Some(compiler) = runtimes::c_compiler() {
        let c = format!(
            "#include <stdio.h>\n{}\nint main(void) {{ const double d[] = SIDC_INPUT_DELAYS; printf(\"%s %g\\n\", SIDC_VERDICT, d[0]); return 0; }}\n",
            exported("c")
        );
        fs::write(at("c.c"), c).unwrap();
        let flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-o"];
        finished(
            Command::new(compiler)
                .args(flags)
                .arg(at("c"))
                .arg(at("c.c"))
                .arg("-lm"),
        );
        assert_eq!(
            finished(&mut Command::new(at("c"))),
            "doubted: dx misfit 0.25\n"
        );
    }
    if let Some(python) = runtimes::python("numpy") {
        fs::write(at("late.py"), exported("python")).unwrap();
        // A function as input is delayed: the ramp u = t acts as t − 0.25. Numbers are taken as delayed already.
        let script = "import late\nprint(late.SIDC_VERDICT, late.SIDC_INPUT_DELAYS)\n\
                      print(late.derivatives(2.0, [0.0], lambda t: [t])[0], late.derivatives(2.0, [0.0], [2.0])[0])\n";
        fs::write(at("run.py"), script).unwrap();
        let args = ["-B", "-W", "error"];
        let said = finished(Command::new(python).args(args).arg(at("run.py")));
        assert_eq!(said, "doubted: dx misfit (0.25,)\n5.25 6.0\n");
    }
}

#[test]
fn commands_that_use_a_doubted_result_say_so_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (doubted, passed, data) = (path("D.json"), path("P.json"), path("d.csv"));
    fs::write(&doubted, text(true)).unwrap();
    fs::write(&passed, text(false)).unwrap();
    let rows: String = (0..40)
        .map(|k| format!("{},0,{}\n", 0.1 * f64::from(k), k % 7))
        .collect();
    fs::write(&data, format!("t,x,u\n{rows}")).unwrap();
    for result in [&doubted, &passed] {
        let calls: [&[&str]; 3] = [
            &["export", result, "--to", "c"],
            &["linearize", result],
            &["simulate", result, &data],
        ];
        for call in calls {
            let run = sidc(call);
            let times = run.stderr.matches("warning[doubted-result]").count();
            assert_eq!(
                times,
                usize::from(result == &doubted),
                "{call:?}\n{}",
                run.stderr
            );
        }
    }
    let run = sidc(&["linearize", &doubted, "--json"]);
    assert!(
        run.stderr.contains("warning[delay-approximated]"),
        "{}",
        run.stderr
    );
    let told: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(
        told["states"],
        serde_json::json!(["x", "u_delay", "du_delay"])
    );
    assert_eq!(told["controllable_rank"], 3);
}
