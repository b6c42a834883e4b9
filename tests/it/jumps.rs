//! States that jump where a condition becomes true (`when y < 0 : dy -> -e*dy`), from readings to equations, document and run.

use crate::disturbed::identify;
use sidc_testing::program::sidc_in;
use sidc_testing::random::Random;

const BALL: &str = "state y : order 2\nunknown e in 0.1 .. 1\nddy ~ <1, dy, y, dy*abs(dy)>\n\
    when y < 0 : dy -> -e*dy\n";

/// Heights every `step` seconds of a ball that leaves the floor with a part e of its speed, until its flights last less than `shortest`.
fn heights(e: f64, step: f64, shortest: f64, random: &mut Random) -> Vec<f64> {
    const G: f64 = 9.81;
    let (mut from, mut y, mut v) = (0.0, random.uniform(1.0, 3.0), random.uniform(-1.0, 2.0));
    let mut out = Vec::new();
    loop {
        let t = step * out.len() as f64;
        let mut flight = (v + f64::sqrt(v * v + 2.0 * G * y)) / G;
        while t >= from + flight {
            (from, y, v) = (from + flight, 0.0, -e * (v - G * flight));
            flight = 2.0 * v / G;
            if flight < shortest {
                return out;
            }
        }
        let s = t - from;
        out.push(y + v * s - 0.5 * G * s * s);
    }
}

/// A table of readings every `step` seconds.
fn table(step: f64, readings: impl Iterator<Item = f64>) -> String {
    let rows = readings.enumerate();
    let rows: String = rows
        .map(|(k, y)| format!("{},{y}\n", step * k as f64))
        .collect();
    format!("t,y\n{rows}")
}

/// Readings of a ball until its flights become short.
fn ball(e: f64, noise: f64, random: &mut Random) -> String {
    let path = heights(e, 0.01, 0.25, random).into_iter();
    table(0.01, path.map(|y| y + noise * random.normal()))
}

/// The value of an unknown constant, and whether its interval holds the truth.
fn constant(found: &serde_json::Value, name: &str, truth: f64) -> (f64, bool) {
    let all = found["unknowns"].as_array().unwrap();
    let own = all.iter().find(|u| u["name"] == name).unwrap();
    let interval = |k: usize| own["interval"][k].as_f64().unwrap_or(f64::NAN);
    let value = own["value"].as_f64().unwrap();
    (
        value,
        interval(0) - 1e-9 <= truth && truth <= interval(1) + 1e-9,
    )
}

/// Of ten balls nine have their law and its constant, seven of these in its interval, and no other law passes. Doubts may remain: by chance
/// another term ties.
fn balls_are_identified(readings: &mut dyn FnMut(f64, &mut Random) -> String) {
    let (mut exact, mut held, mut passed, mut random) = (0, 0, 0, Random::new(3));
    for _ in 0..10 {
        let e = random.uniform(0.6, 0.92);
        let text = readings(e, &mut random);
        let (run, found) = identify(BALL, &text, &[]);
        let terms = found["equations"][0]["terms"].as_array().unwrap();
        let g = terms[0]["coefficient"].as_f64().unwrap();
        let (value, holds) = constant(&found, "e", e);
        let right = terms.len() == 1 && (g + 9.81).abs() < 0.05 && (value - e).abs() < 0.005;
        let passes = run.stdout.contains("law: passes");
        assert!(right || !passes, "{value} for {e}\n{}", run.stdout);
        exact += usize::from(right);
        held += usize::from(right && holds);
        passed += usize::from(passes);
    }
    let counts = (exact, held, passed);
    assert!(
        exact >= 9 && held >= 7 && passed >= 6,
        "{counts:?} of ten balls"
    );
}

#[test]
fn a_ball_bounces() {
    for noise in [0.0, 0.005] {
        balls_are_identified(&mut |e, random| ball(e, noise, random));
    }
}

/// Its flights become shorter than any in which readings show a law, and it lies on the floor for a second.
#[test]
fn a_ball_comes_to_rest() {
    for noise in [0.0, 0.002] {
        balls_are_identified(&mut |e, random| {
            let path = heights(e, 0.01, 1e-6, random).into_iter();
            table(
                0.01,
                path.chain([0.0; 100]).map(|y| y + noise * random.normal()),
            )
        });
    }
}

/// Parabolas follow rounded readings better than their rounding allows, here and there: no kink.
#[test]
fn a_ball_bounces_whose_heights_are_rounded() {
    balls_are_identified(&mut |e, random| {
        let path = heights(e, 0.01, 0.25, random).into_iter();
        table(0.01, path.map(|y| (y * 1000.0).round() / 1000.0))
    });
}

/// Thirty pictures a second, errors of 4 mm. Two pictures that show something else may spoil the law, but then it does not pass.
#[test]
fn a_camera_sees_a_ball() {
    let step = 1.0 / 30.0;
    balls_are_identified(&mut |e, random| {
        let path = heights(e, step, 0.3, random).into_iter();
        table(step, path.map(|y| y + 0.004 * random.normal()))
    });
    let mut random = Random::new(5);
    for _ in 0..10 {
        let path = heights(0.8, step, 0.3, &mut random);
        let mut readings: Vec<f64> = path.iter().map(|y| y + 0.004 * random.normal()).collect();
        for k in [20, 77] {
            readings[k] += random.uniform(-0.5, 0.5);
        }
        let (run, found) = identify(BALL, &table(step, readings.into_iter()), &[]);
        let e = constant(&found, "e", 0.8).0;
        let is_right = (e - 0.8).abs() < 0.02;
        assert!(
            is_right || !run.stdout.contains("law: passes"),
            "{}",
            run.stdout
        );
    }
}

/// A drive that stays at its stop as long as it is pressed against it: for long, or for a few readings. ddx = 1.5 F.
#[test]
fn a_drive_stays_at_its_stop() {
    let model = "state x : order 2\ninput F : hold\nddx ~ <1, dx, x, F>\nwhen x > 0.2 : dx -> 0\n";
    let mut random = Random::new(11);
    let (mut x, mut v, mut force) = (0.0, 0.0, 0.0);
    let mut text = String::from("t,x,F\n");
    for k in 0..1200 {
        if k % 30 == 0 {
            // Back towards the middle, and now and then into the stop.
            force = random.uniform(-1.0, 1.4) - 1.2 * x - v;
        }
        let t = 0.01 * f64::from(k);
        text += &format!("{t},{},{force}\n", x + 2e-4 * random.normal());
        let a = 1.5 * force;
        if x >= 0.2 && a > 0.0 {
            continue;
        }
        (x, v) = (x + 0.01 * v + 0.5e-4 * a, v + 0.01 * a);
        if x > 0.2 && v > 0.0 {
            (x, v) = (0.2, 0.0);
        }
    }
    let (run, found) = identify(model, &text, &[]);
    assert!(run.stdout.contains("law: passes"), "{}", run.stdout);
    assert!(
        run.stdout.matches("not used: ").count() >= 3,
        "{}",
        run.stdout
    );
    assert_eq!(found["equations"][0]["terms"][0]["term"], "F");
    assert!(found["rests"][0]["to"].as_f64() > found["rests"][0]["from"].as_f64());
}

/// A leaky cell that fires: threshold and reset unknown, driven by a current.
#[test]
fn a_neuron_fires() {
    let model = "state v : unit \"mV\"\ninput I : hold\nunknown top in -55 .. -40, unit \"mV\"\n\
        unknown low in -80 .. -60, unit \"mV\"\ndv ~ <1, v, I, v^2>\nwhen v > top : v -> low\n";
    for noise in [0.0, 0.1] {
        let mut random = Random::new(8);
        let (mut v, mut text) = (-65.0, String::from("t,v,I\n"));
        for k in 0..800 {
            let t = 0.5 * f64::from(k);
            let current = 22.0 + 4.0 * f64::sin(0.07 * t);
            text += &format!("{t},{},{current}\n", v + noise * random.normal());
            let (mut left, rest) = (0.5, -65.0 + current);
            loop {
                let fires = match rest > -50.0 {
                    true => 12.0 * f64::ln((rest - v) / (rest + 50.0)),
                    false => f64::INFINITY,
                };
                if fires > left {
                    v = rest + (v - rest) * f64::exp(-left / 12.0);
                    break;
                }
                (v, left) = (-68.0, left - fires);
            }
        }
        let (run, found) = identify(model, &text, &[]);
        assert!(
            run.stdout.contains("law: passes"),
            "{noise}\n{}",
            run.stdout
        );
        let terms = found["equations"][0]["terms"].as_array().unwrap();
        let names: Vec<&str> = terms.iter().map(|t| t["term"].as_str().unwrap()).collect();
        assert_eq!(names, ["1", "v", "I"], "{}", run.stdout);
        let (top, low) = (
            constant(&found, "top", -50.0),
            constant(&found, "low", -68.0),
        );
        assert!(
            (top.0 + 50.0).abs() < 0.15 && (low.0 + 68.0).abs() < 0.3,
            "{}",
            run.stdout
        );
    }
}

/// A room whose heater goes off at one temperature and on at another: the relay is recorded.
#[test]
fn a_relay_has_hysteresis() {
    let model = "state T, on\nunknown low in 15 .. 20\nunknown high in 20 .. 25\n\
        dT ~ <1, T, on>\ndon = 0\nwhen T > high : on -> 0\nwhen T < low : on -> 1\n";
    let (mut room, mut on, mut text) = (15.0, 1.0, String::from("t,T,on\n"));
    for k in 0..600 {
        text += &format!("{},{room},{on}\n", 0.1 * f64::from(k));
        let mut left = 0.1;
        loop {
            let (rest, bound) = (5.0 + 30.0 * on, if on > 0.0 { 21.0 } else { 19.0 });
            let reach = 10.0 * f64::ln((rest - room) / (rest - bound));
            if !(reach >= 0.0 && reach < left) {
                room = rest + (room - rest) * f64::exp(-left / 10.0);
                break;
            }
            (room, on, left) = (bound, 1.0 - on, left - reach);
        }
    }
    let (run, found) = identify(model, &text, &[]);
    assert!(run.stdout.contains("law: passes"), "{}", run.stdout);
    let (low, high) = (
        constant(&found, "low", 19.0),
        constant(&found, "high", 21.0),
    );
    assert!(
        (low.0 - 19.0).abs() < 1e-4 && (high.0 - 21.0).abs() < 1e-4,
        "{}",
        run.stdout
    );
}

/// A library without the drag that acts: no pass.
#[test]
fn a_missing_term_is_doubted() {
    let mut random = Random::new(5);
    let mut text = String::from("t,y\n");
    let (mut y, mut v) = (2.0, 0.0);
    for k in 0..400 {
        text += &format!("{},{}\n", 0.01 * f64::from(k), y + 0.001 * random.normal());
        for _ in 0..100 {
            v += 1e-4 * (-9.81 - 0.4 * v * f64::abs(v));
            y += 1e-4 * v;
            if y < 0.0 && v < 0.0 {
                v *= -0.8;
            }
        }
    }
    let model =
        "state y : order 2\nunknown e in 0.1 .. 1\nddy ~ <1, y>\nwhen y < 0 : dy -> -e*dy\n";
    let (run, _) = identify(model, &text, &[]);
    assert!(!run.stdout.contains("law: passes"), "{}", run.stdout);
}

/// The result knows the jumps: it runs them, and prints them.
#[test]
fn a_result_runs_its_jumps() {
    let folder = tempfile::tempdir().unwrap();
    let text = ball(0.8, 0.0, &mut Random::new(1));
    std::fs::write(folder.path().join("m.sid"), BALL).unwrap();
    std::fs::write(folder.path().join("d.csv"), &text).unwrap();
    let sidc = |arguments: &[&str]| sidc_in(folder.path(), arguments);
    let run = sidc(&["identify", "m.sid", "d.csv", "-o", "r.json"]);
    assert!(
        run.stdout.contains("when y < 0 : dy -> -e*dy\ne = 0."),
        "{}",
        run.stdout
    );
    let read = |name: &str, text: &str| {
        let rows = text.lines().filter(|l| !l.starts_with('#'));
        let mut rows = rows.map(|l| l.split(',').map(str::to_string).collect::<Vec<_>>());
        let head = rows.next().unwrap();
        let column = head.iter().position(|h| h == name).unwrap();
        rows.map(move |r| r[column].parse::<f64>().unwrap())
            .collect::<Vec<f64>>()
    };
    sidc(&["simulate", "r.json", "d.csv", "-o", "run.csv"]);
    let measured = read("y", &text);
    let ran = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let simulated = read("y", &ran);
    assert_eq!(measured.len(), simulated.len());
    let worst = measured.iter().zip(&simulated).map(|(a, b)| (a - b).abs());
    assert!(worst.fold(0.0, f64::max) < 1e-5);
    let code = sidc(&["export", "r.json", "--to", "python"]);
    assert!(code.stdout.contains("def jumps("), "{}", code.stderr);
    let none = sidc(&["export", "r.json", "--to", "julia"]);
    assert!(
        none.stderr
            .contains("the export to Julia lets no states jump"),
        "{}",
        none.stderr
    );
    let text = sidc(&["export", "r.json", "--to", "text"]);
    assert!(
        text.stdout.contains("when y < 0 : dy -> -e*dy"),
        "{}",
        text.stdout
    );
    sidc(&["report", "r.json", "d.csv", "-o", "r.html"]);
    let page = std::fs::read_to_string(folder.path().join("r.html")).unwrap();
    assert!(page.contains("when y &lt; 0 : dy -&gt; -e*dy"));
    let weak = sidc(&["identify", "m.sid", "d.csv", "--method", "weak"]);
    assert!(
        weak.stderr.contains("resets-not-estimated"),
        "{}",
        weak.stderr
    );
}
