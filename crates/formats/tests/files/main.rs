//! Files that NumPy, SciPy, Octave, pyarrow, polars and h5py wrote (tests/data/make.py, make_columns.py): ten rows of t = 0, 0.1, …, and x = t².

#![allow(clippy::unwrap_used, clippy::panic)]

mod logs;

use sidc_data::Limits;
use sidc_formats::{FileTable, read};
use sidc_lang::source::Sources;

const LIMITS: Limits = Limits {
    columns: 1_000,
    file_bytes: 1 << 20,
    line_bytes: 1 << 16,
    table_bytes: 1 << 24,
    taken: 0,
};

fn bytes(file: &str) -> Vec<u8> {
    let path = format!("{}/tests/data/{file}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(path).unwrap()
}

/// The table, or its faults as text.
fn reading(name: &str, bytes: &[u8], limits: &Limits) -> Result<FileTable, String> {
    let faults = read(name, bytes, limits, &mut Sources::default());
    faults.map_err(|found| {
        let line = |d: &sidc_lang::diagnostic::Diagnostic| {
            let help = d.help.clone().unwrap_or_default();
            format!("[{}] {} | {help}", d.code, d.message)
        };
        found.iter().map(line).collect::<Vec<_>>().join("\n")
    })
}

fn table(file: &str) -> FileTable {
    reading(file, &bytes(file), &LIMITS).unwrap()
}

fn column(found: &FileTable, name: &str) -> Vec<f64> {
    let place = found.table.position(name);
    let place = place.unwrap_or_else(|| panic!("{name} in {:?}", found.table.headers()));
    found.table.values(place).to_vec()
}

fn cells(found: &FileTable, name: &str) -> Vec<String> {
    let place = found.table.position(name).unwrap();
    let rows = 0..found.table.len();
    rows.map(|row| found.table.cell(row, place).into_owned())
        .collect()
}

fn note(found: &FileTable) -> &str {
    found.notes.first().map_or("", |note| &note.message)
}

fn time() -> Vec<f64> {
    (0..10).map(|k| f64::from(k) / 10.0).collect()
}

fn squares(sign: f64) -> Vec<f64> {
    time().iter().map(|t| sign * t * t).collect()
}

fn close(found: &[f64], true_values: &[f64], relative: f64) -> bool {
    let mut pairs = found.iter().zip(true_values);
    found.len() == true_values.len() && pairs.all(|(a, b)| (a - b).abs() <= relative * b.abs())
}

const RUNS: [&str; 10] = ["a", "a", "a", "a", "a", "b", "b", "b", "b", "b"];

#[test]
fn arrays_of_numpy() {
    let found = table("stored.npz");
    let names = ["t", "x", "run", "date", "pair_0", "pair_1", "count"];
    assert_eq!(found.table.headers(), names);
    assert_eq!(found.table.len(), 10);
    assert_eq!(column(&found, "t"), time());
    assert_eq!(column(&found, "x"), squares(1.0));
    assert_eq!(column(&found, "pair_1"), squares(-1.0));
    assert_eq!(column(&found, "date"), time());
    let counts: Vec<f64> = (0..10).map(f64::from).collect();
    assert_eq!(column(&found, "count"), counts);
    assert_eq!(cells(&found, "run"), RUNS);
    assert_eq!(
        note(&found),
        "stored.npz: not read as columns: Ts (one number, 0.1), words (objects of Python)"
    );

    let found = table("packed.npz");
    assert!(found.notes.is_empty());
    assert_eq!(column(&found, "pair_0"), squares(1.0));
    assert!(close(&column(&found, "half"), &squares(1.0), 1e-3));
    assert!(close(&column(&found, "single"), &squares(1.0), 1e-7));
    assert_eq!(column(&found, "flag").iter().sum::<f64>(), 5.0);

    let found = table("fields.npy");
    assert_eq!(found.table.headers(), ["t", "x", "run"]);
    assert!(close(&column(&found, "x"), &squares(1.0), 1e-7));
    assert_eq!(cells(&found, "run"), RUNS);
    assert!(note(&found).contains("both (an array in each row)"));
}

#[test]
fn variables_of_matlab() {
    let found = table("scipy.mat");
    let names = ["t", "x", "pair_1", "pair_2", "n", "run"];
    assert_eq!(found.table.headers(), names);
    assert_eq!(column(&found, "t"), time());
    assert_eq!(column(&found, "pair_2"), squares(-1.0));
    assert_eq!(cells(&found, "run"), RUNS);
    assert_eq!(
        note(&found),
        "scipy.mat: not read as columns: Ts (one number, 0.1), note (one text), z (complex numbers)"
    );

    assert_eq!(found.notes[0].help, None);

    // No column of times, and a number that is named like a sampling interval.
    let found = table("timeless.npz");
    assert_eq!(found.table.headers(), ["u", "y"]);
    let help = found.notes[0].help.as_deref().unwrap();
    assert!(help.ends_with("data { step 0.05 }"), "{help}");

    let found = table("octave7.mat");
    let names = ["t", "pair_1", "pair_2", "run", "ok"];
    assert_eq!(found.table.headers(), names);
    assert_eq!(cells(&found, "run")[4..6], ["aa", "b"]);
    assert_eq!(
        note(&found),
        "octave7.mat: not read as columns: rig (a cell array), s (a sparse matrix)"
    );

    let found = table("octave6.mat");
    assert_eq!(found.table.headers(), ["t", "data_x", "more_x", "ok"]);
    assert!(close(&column(&found, "data_x"), &squares(1.0), 1e-7));
    assert_eq!(column(&found, "more_x"), squares(-1.0));
}

#[cfg(feature = "parquet")]
#[test]
fn columns_of_parquet() {
    for packed in ["snappy", "zstd", "gzip", "lz4", "none"] {
        is_the_frame(&table(&format!("{packed}.parquet")));
    }
}

/// What is true of every file of columns.
fn is_the_frame(found: &FileTable) {
    let names = ["t", "x", "count", "run", "date", "single", "both_a"];
    assert_eq!(found.table.headers(), names);
    assert_eq!(column(found, "t"), time());
    let x = column(found, "x");
    assert!(x[0].is_nan());
    assert_eq!(x[1..], squares(1.0)[1..]);
    assert_eq!(column(found, "date"), time());
    assert_eq!(cells(found, "run"), RUNS);
    assert!(close(&column(found, "both_a"), &squares(1.0), 0.0));
    assert!(note(found).contains("both_b"));
    assert!(note(found).contains("(no numbers and no text)"));
}

#[cfg(feature = "hdf5")]
#[test]
fn arrays_of_hdf5() {
    let found = table("v73.mat");
    let names = ["n", "ok", "pair_1", "pair_2", "t", "x", "rig_t", "y", "z"];
    assert_eq!(found.table.headers(), names);
    assert_eq!(column(&found, "t"), time());
    assert_eq!(column(&found, "rig_t"), time());
    assert_eq!(column(&found, "pair_2"), squares(-1.0));
    assert_eq!(column(&found, "y"), squares(-1.0));
    assert!(close(&column(&found, "x"), &squares(1.0), 1e-7));
    assert_eq!(column(&found, "ok").iter().sum::<f64>(), 5.0);
    assert_eq!(
        note(&found),
        "v73.mat: not read as columns: Ts (one number, 0.1), cells (a cell array), complex (complex numbers), \
         none (empty), note (text)"
    );
    let found = table("plain.h5");
    assert_eq!(found.table.headers(), ["ok", "t", "x"]);
    assert_eq!(column(&found, "x"), squares(1.0));
    // Ten numbers, in a chunk that is larger than all tables may be.
    let text = reading("tight.h5", &bytes("tight.h5"), &LIMITS).unwrap_err();
    assert!(text.starts_with("[table-too-large]"), "{text}");
    // A file may end in bytes that nothing needs.
    let whole = bytes("plain.h5");
    for length in (8..whole.len() / 2).step_by(11) {
        assert!(
            reading("cut", &whole[..length], &LIMITS).is_err(),
            "{length}"
        );
    }
}

#[cfg(not(feature = "hdf5"))]
#[test]
fn hdf5_without_its_reader_is_told_what_to_do() {
    let text = reading("v73.mat", &bytes("v73.mat"), &LIMITS).unwrap_err();
    let told = "[not-text] v73.mat is an HDF5 or MATLAB 7.3 file, and this program was built without them | in MATLAB, save";
    assert!(text.starts_with(told), "{text}");
}

#[test]
fn columns_of_arrow() {
    for packed in ["lz4", "zstd", "uncompressed"] {
        is_the_frame(&table(&format!("{packed}.feather")));
    }
    let found = table("more.arrows");
    let names = [
        "ok", "large", "half", "day", "clock", "span", "nothing", "view", "maybe_a", "t",
    ];
    assert_eq!(found.table.headers(), names);
    assert_eq!(column(&found, "t"), time());
    assert_eq!(column(&found, "clock"), time());
    assert_eq!(column(&found, "span"), time());
    assert_eq!(column(&found, "day")[2], 86_400.0);
    assert_eq!(column(&found, "ok").iter().sum::<f64>(), 5.0);
    assert!(close(&column(&found, "half"), &squares(1.0), 1e-3));
    assert!(column(&found, "nothing")[9].is_nan());
    let maybe = column(&found, "maybe_a");
    assert!(maybe[3].is_nan() && maybe[2] == 0.2 * 0.2 && maybe[9] == 0.9 * 0.9);
    assert_eq!(cells(&found, "large"), RUNS);
    assert_eq!(cells(&found, "view")[8..], ["b", "b, whose name is long"]);
    for other in ["union", "bytes", "pair", "runs"] {
        assert!(note(&found).contains(other), "{}", note(&found));
    }

    let found = table("polars.arrow");
    assert_eq!(column(&found, "x"), squares(1.0));
    assert_eq!(cells(&found, "run"), RUNS);
    assert_eq!(cells(&found, "kind"), RUNS);
}

/// A file is refused wherever it is cut; a stream is shorter if it is cut between two messages.
#[test]
fn cut_files_of_arrow_are_refused() {
    let whole = bytes("lz4.feather");
    for length in 8..whole.len() {
        let text = reading("cut", &whole[..length], &LIMITS).unwrap_err();
        assert!(text.starts_with("[damaged-file] cut"), "{length}: {text}");
    }
    let whole = bytes("more.arrows");
    for length in 8..whole.len() {
        match reading("cut", &whole[..length], &LIMITS) {
            Ok(found) => assert!([7, 10].contains(&found.table.len()), "{length}"),
            Err(text) => assert!(!text.is_empty()),
        }
    }
}

#[cfg(not(feature = "parquet"))]
#[test]
fn parquet_without_its_reader_is_told_what_to_do() {
    let text = reading("a.parquet", &bytes("snappy.parquet"), &LIMITS).unwrap_err();
    assert_eq!(
        text,
        "[not-text] a.parquet is a Parquet file, and this program was built without them | \
         build it with --profile embedded --features parquet, give the file to sidc in Python, or export the data as CSV"
    );
}

#[test]
fn text_is_read_as_before() {
    let found = reading("a.csv", b"t;x\n0;1,5\n1;2,5\n", &LIMITS).unwrap();
    assert_eq!(column(&found, "x"), [1.5, 2.5]);
    let empty = reading("a.csv", b"", &LIMITS).unwrap_err();
    assert!(empty.starts_with("[empty-file]"), "{empty}");
}

/// An archive whose first entry is that of a workbook.
fn workbook() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut archive = rawzip::ZipArchiveWriter::new(&mut bytes);
    let entry = archive.new_file("[Content_Types].xml").start();
    let (mut entry, config) = entry.unwrap();
    let writer = config.wrap(&mut entry);
    let (_, descriptor) = writer.finish().unwrap();
    entry.finish(descriptor).unwrap();
    archive.finish().unwrap();
    bytes
}

#[test]
fn what_is_no_table_says_what_it_is() {
    let cut = |file: &str, length: usize| bytes(file)[..length].to_vec();
    let cases: [(&str, Vec<u8>, &str); 6] = [
        (
            "book.xlsx",
            workbook(),
            "[not-text] book.xlsx is an Excel workbook | export the data as CSV in UTF-8",
        ),
        (
            "nameless.npy",
            bytes("nameless.npy"),
            "[no-columns] nameless.npy holds no columns with names: it is one array of NumPy | \
             save each signal under its name: numpy.savez(\"data.npz\", t=t, x=x)",
        ),
        (
            "cut.npz",
            cut("packed.npz", 300),
            "[damaged-file] cut.npz: it is no whole ZIP archive",
        ),
        ("cut.mat", cut("scipy.mat", 600), "[damaged-file] cut.mat"),
        (
            "a.gz",
            b"\x1f\x8b\x08".to_vec(),
            "[not-text] a.gz is compressed with gzip",
        ),
        (
            "a.arrow",
            b"ARROW1\0\0".to_vec(),
            "[damaged-file] a.arrow: its end is missing",
        ),
    ];
    for (name, content, expected) in cases {
        let text = reading(name, &content, &LIMITS).unwrap_err();
        assert!(text.starts_with(expected), "{text}");
    }
}

#[test]
fn memory_is_asked_for_before_it_is_taken() {
    let content = |file: &str| bytes(file);
    for file in [
        "stored.npz",
        "packed.npz",
        "scipy.mat",
        "octave6.mat",
        "zstd.feather",
        "more.arrows",
    ] {
        let content = content(file);
        let small = Limits {
            table_bytes: content.len() as u64 + 300,
            ..LIMITS
        };
        let text = reading(file, &content, &small).unwrap_err();
        assert!(text.starts_with("[table-too-large]"), "{text}");
    }
    let few = Limits {
        columns: 3,
        ..LIMITS
    };
    let text = reading("stored.npz", &content("stored.npz"), &few).unwrap_err();
    assert!(text.starts_with("[too-many-columns]"), "{text}");
}

/// A file with changed or missing bytes is a table or a fault: no panic, no endless loop, no more memory than allowed.
#[test]
fn damaged_files_are_refused_or_read() {
    let mut random = 88_172_645_463_325_252u64;
    let mut next = move || {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        random as usize
    };
    let mut files = vec![
        "stored.npz",
        "packed.npz",
        "fields.npy",
        "scipy.mat",
        "octave7.mat",
        "octave6.mat",
        "lz4.feather",
        "zstd.feather",
        "more.arrows",
        "polars.arrow",
        "pendulum.ulg",
        "none.mcap",
        "lz4.mcap",
        "zstd.mcap",
    ];
    if cfg!(feature = "hdf5") {
        files.extend(["v73.mat", "plain.h5"]);
    }
    if cfg!(feature = "parquet") {
        files.extend(["snappy.parquet", "zstd.parquet", "gzip.parquet"]);
        files.extend(["lz4.parquet", "none.parquet"]);
    }
    for file in files {
        let whole = bytes(file);
        for _ in 0..2_000 {
            let mut content = whole.clone();
            for _ in 0..=next() % 4 {
                let at = next() % content.len();
                content[at] = next() as u8;
            }
            if next() % 4 == 0 {
                content.truncate(next() % whole.len());
            }
            let _ = reading(file, &content, &LIMITS);
        }
    }
}
