//! Logs of a pendulum that tests/data/make_logs.py wrote: its angle at 100 Hz, its torque at 40 Hz, a status every second.

use super::{LIMITS, bytes, note, reading, table};
use sidc_data::Limits;
use sidc_formats::FileTable;

/// The values of a column, with the times at which they were logged.
fn logged(found: &FileTable, name: &str) -> Vec<(f64, f64)> {
    let table = found.table.of_columns(&|column| column == name).unwrap();
    assert_eq!(table.headers(), ["t", name]);
    let times = table.values(0).iter().copied();
    times.zip(table.values(1).iter().copied()).collect()
}

fn times(found: &FileTable, name: &str) -> Vec<f64> {
    logged(found, name).into_iter().map(|(t, _)| t).collect()
}

/// What is true of every log of the pendulum.
fn is_the_pendulum(found: &FileTable, seconds: usize, angle: &str, torque: &str) {
    let every = |step: f64, count: usize| (0..=count).map(move |k| k as f64 / step);
    let same = |found: Vec<f64>, wanted: Vec<f64>| {
        assert_eq!(found.len(), wanted.len());
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
        assert!(found.iter().zip(&wanted).all(near), "{found:?}");
    };
    same(times(found, angle), every(100.0, 100 * seconds).collect());
    same(times(found, torque), every(40.0, 40 * seconds).collect());
    assert_eq!(logged(found, angle)[0], (0.0, 0.8));
    assert!((logged(found, torque)[0].1 - 0.5).abs() < 1e-6);
    // Together they have a row for each time at which one was logged.
    let both = found
        .table
        .of_columns(&|name| name == angle || name == torque);
    let both = both.unwrap();
    assert_eq!(both.len(), 100 * seconds + 1 + 20 * seconds);
    let empty = both.values(2).iter().filter(|x| x.is_nan()).count();
    assert_eq!(empty, both.len() - 40 * seconds - 1);
}

#[test]
fn a_log_of_px4() {
    let found = table("pendulum.ulg");
    let names = [
        "t",
        "encoder_position_0",
        "encoder_position_1",
        "motor_torque",
        "status_0_health_count",
        "status_0_armed",
        "status_1_health_count",
        "status_1_armed",
    ];
    assert_eq!(found.table.headers(), names);
    is_the_pendulum(&found, 8, "encoder_position_0", "motor_torque");
    let armed = logged(&found, "status_1_armed");
    assert_eq!(armed[3], (3.000_003, 1.0));
    let left_out = "pendulum.ulg: not read as columns: motor_unit (text)";
    assert_eq!(note(&found), left_out);
}

/// A log of these messages.
fn small(messages: &[(u8, &[u8])]) -> Vec<u8> {
    let mut out = b"ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0".to_vec();
    for (kind, content) in messages {
        out.extend((content.len() as u16).to_le_bytes());
        out.push(*kind);
        out.extend(*content);
    }
    out
}

#[test]
fn logs_of_robots() {
    for (packed, seconds) in [("none", 2), ("lz4", 2), ("zstd", 8)] {
        let found = table(&format!("{packed}.mcap"));
        let mut names = vec![
            "t",
            "encoder_header_stamp",
            "encoder_position_0",
            "encoder_velocity_0",
            "motor_wrench_on",
            "motor_wrench_torque_x",
            "motor_wrench_torque_y",
            "motor_wrench_torque_z",
            "status_armed",
            "status_health_count",
        ];
        if packed == "none" {
            names.insert(5, "motor_wrench_age");
            assert_eq!(logged(&found, "motor_wrench_age")[7].1, 1.5);
        }
        assert_eq!(found.table.headers(), names);
        is_the_pendulum(&found, seconds, names[2], "motor_wrench_torque_z");
        let (time, stamp) = logged(&found, "encoder_header_stamp")[3];
        assert!((time - stamp - 0.002).abs() < 1e-9);
        assert_eq!(logged(&found, "status_armed")[1], (1.000_003, 1.0));
        let left_out = format!(
            "{packed}.mcap: not read as columns: /camera (protobuf), encoder_header_frame_id (text), \
             encoder_name_0 (text), motor_wrench_picture (a long list), status_health_text (text)"
        );
        assert_eq!(note(&found), left_out);
    }
}

#[test]
fn a_cut_log_is_shorter() {
    for whole in [bytes("none.mcap"), bytes("zstd.mcap")] {
        for length in (0..whole.len()).step_by(97) {
            let _ = reading("cut.mcap", &whole[..length], &LIMITS);
        }
        let found = reading("cut.mcap", &whole[..whole.len() * 2 / 3], &LIMITS).unwrap();
        assert!(
            note(&found).contains("in the middle of a record"),
            "{}",
            note(&found)
        );
    }
    let whole = bytes("pendulum.ulg");
    let lengths = [1_000, 5_000, 20_001].map(|length| {
        let found = reading("cut.ulg", &whole[..length], &LIMITS).unwrap();
        assert!(
            note(&found).contains("in the middle of a message"),
            "{}",
            note(&found)
        );
        times(&found, "encoder_position_0").len()
    });
    assert!(lengths.is_sorted() && lengths[2] > 300, "{lengths:?}");
    for length in 0..1_200 {
        if let Err(text) = reading("cut.ulg", &whole[..length], &LIMITS) {
            let codes = [
                "[damaged-file]",
                "[no-columns]",
                "[empty-file]",
                "[not-text]",
                "[no-",
            ];
            assert!(codes.iter().any(|code| text.starts_with(code)), "{text}");
        }
    }
}

/// What was added after a crash begins after a message that the crash cut off.
#[test]
fn what_was_appended_is_read() {
    let mut flags = [0u8; 40];
    flags[8] = 1;
    let format: (u8, &[u8]) = (b'F', b"a:uint64_t timestamp;uint16_t x;");
    let topic: (u8, &[u8]) = (b'A', b"\0\x05\0a");
    let data: (u8, &[u8]) = (b'D', b"\x05\0\x40\x42\x0f\0\0\0\0\0\x07\0");
    let later: (u8, &[u8]) = (b'D', b"\x05\0\x80\x84\x1e\0\0\0\0\0\x08\0");
    let cut = small(&[(b'B', &flags), format, topic, data, data]).len() - 4;
    flags[16..24].copy_from_slice(&(cut as u64).to_le_bytes());
    let mut log = small(&[(b'B', &flags), format, topic, data, data]);
    log.truncate(cut);
    log.extend(&small(&[later])[16..]);
    let found = reading("crash.ulg", &log, &LIMITS).unwrap();
    assert_eq!(logged(&found, "a_x"), [(1.0, 7.0), (2.0, 8.0)]);
    flags[9] = 1;
    let newer = small(&[(b'B', &flags), format, topic, data]);
    let text = reading("new.ulg", &newer, &LIMITS).unwrap_err();
    assert!(
        text.starts_with("[not-text] new.ulg is a log of PX4 of a later version"),
        "{text}"
    );
}

/// Records of an MCAP file: two channels, a message of each.
fn bag(packing: &str, length: u64, lists: u32) -> Vec<u8> {
    let mut out = b"\x89MCAP0\r\n".to_vec();
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let mut record = |kind: u8, content: &[&[u8]]| {
        let content = content.concat();
        out.push(kind);
        out.extend((content.len() as u64).to_le_bytes());
        out.extend(content);
    };
    let time = [7, 0, 0, 0, 0, 0, 0, 0];
    record(
        3,
        &[
            &[1, 0],
            &text("a/A"),
            &text("ros1msg"),
            &text("float64 x\nfloat64[] y\n"),
        ],
    );
    record(4, &[&[1, 0, 1, 0], &text("/a"), &text("ros1"), &[0; 4]]);
    record(4, &[&[2, 0, 0, 0], &text("/b"), &text("json"), &[0; 4]]);
    let value = 2.5f64.to_le_bytes();
    record(
        5,
        &[
            &[1, 0],
            &[0; 4],
            &time,
            &time,
            &value,
            &lists.to_le_bytes(),
            &[0; 8],
        ],
    );
    record(
        5,
        &[
            &[2, 0],
            &[0; 4],
            &time,
            &time,
            b"{\"x y\": [1, null, true]}",
        ],
    );
    let size = if packing.is_empty() { 0 } else { 9 };
    record(
        6,
        &[
            &[0; 16],
            &[size],
            &[0; 11],
            &text(packing),
            &length.to_le_bytes(),
            &[0; 4],
        ],
    );
    out
}

#[test]
fn bags_that_lie_are_refused() {
    let read = |packing: &str, length: u64, lists: u32| {
        let text = reading("a.mcap", &bag(packing, length, lists), &LIMITS).err();
        text.unwrap_or_default()
    };
    let cases = [
        ("", 0, 1, ""),
        ("", 0, 2, "8 bytes are announced where 0 are left"),
        (
            "",
            0,
            u32::MAX,
            "34359738360 bytes are announced where 8 are left",
        ),
        ("", u64::MAX, 1, "bytes are announced where 4 are left"),
        ("zstd", 4, 1, "it cannot be unpacked"),
        ("lz4", 4, 1, "9 bytes are announced where 0 were packed"),
        ("rar", 4, 1, "is a log packed by rar"),
    ];
    for (packing, length, lists, expected) in cases {
        let text = read(packing, length, lists);
        let same = text.contains(expected) && text.is_empty() == expected.is_empty();
        assert!(same, "{packing} {length} {lists}: {text}");
    }
    let found = reading("a.mcap", &bag("", 0, 1), &LIMITS).unwrap();
    assert_eq!(
        found.table.headers(),
        ["t", "a_x", "a_y_0", "b_x_y_0", "b_x_y_2"]
    );
    assert_eq!(logged(&found, "a_x"), [(0.0, 2.5)]);
    // A single changed bit of a chunk is found.
    let mut content = bytes("none.mcap");
    let place = content.len() / 2;
    content[place] ^= 1;
    let text = reading("none.mcap", &content, &LIMITS).unwrap_err();
    assert!(text.starts_with("[damaged-file] none.mcap, byte"), "{text}");
}

#[test]
fn formats_that_lie_are_refused() {
    let topic: (u8, &[u8]) = (b'A', b"\0\x05\0a");
    let data: (u8, &[u8]) = (b'D', b"\x05\0\x40\x42\x0f\0\0\0\0\0\x07\0");
    let cases: [(&[&[u8]], &str); 6] = [
        (
            &[b"a:uint64_t timestamp;float[4000000000] x;"],
            "longer than a message can be",
        ),
        (&[b"a:uint64_t timestamp;a x;"], "is unknown"),
        (
            &[
                b"a:uint64_t timestamp;b[60000] x;",
                b"b:c[60000] x;",
                b"c:d[60000] x;",
                b"d:;",
            ],
            "longer than a message can be",
        ),
        (&[b"a:uint16_t x;"], "have no timestamp"),
        (
            &[b"a:uint64_t timestamp;double x;"],
            "a message of 10 bytes, where its format has 16",
        ),
        (&[b"a"], "a format that cannot be read"),
    ];
    for (formats, expected) in cases {
        let formats = formats.iter().map(|format| (b'F', *format));
        let messages: Vec<(u8, &[u8])> = formats.chain([topic, data]).collect();
        let text = reading("a.ulg", &small(&messages), &LIMITS).unwrap_err();
        assert!(
            text.starts_with("[damaged-file] a.ulg, byte") && text.contains(expected),
            "{text}"
        );
    }
}

#[test]
fn memory_of_logs_is_asked_for_before_it_is_taken() {
    for (log, values) in [("pendulum.ulg", 60_000), ("none.mcap", 60_000)] {
        let content = bytes(log);
        let limits = |more: u64| Limits {
            table_bytes: content.len() as u64 + more,
            ..LIMITS
        };
        let text = reading(log, &content, &limits(5_000)).unwrap_err();
        assert!(text.starts_with("[table-too-large]"), "{text}");
        // The values fit, all columns in one table do not.
        let found = reading(log, &content, &limits(values)).unwrap();
        let text = found.table.of_columns(&|_| true).unwrap_err().text();
        assert!(
            text.contains("more than what the memory limit leaves"),
            "{text}"
        );
    }
}
