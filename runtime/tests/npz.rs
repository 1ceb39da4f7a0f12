//! `sweep --npz`: the table as NumPy's arrays, with the numbers of the one that is text.
#![cfg(feature = "cli")]

use std::fs;

const MODEL: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/double_pendulum.yaml");

fn run(arguments: &[&str]) -> Result<String, String> {
    let mut out = Vec::new();
    dalembert::cli::run(&[], [&["dalembert"], arguments].concat(), &mut out).map_err(|problem| problem.to_string())?;
    Ok(String::from_utf8(out).unwrap())
}

/// What describes an array of an archive, and its data, of three numbers of eight bytes.
fn array(bytes: &[u8], name: &str) -> (String, Vec<u8>) {
    let name = format!("{name}.npy\u{93}NUMPY");
    let wanted: Vec<u8> = name.chars().map(|letter| letter as u8).collect();
    let start = bytes.windows(wanted.len()).position(|window| window == wanted).unwrap() + wanted.len();
    let size = usize::from(u16::from_le_bytes([bytes[start + 2], bytes[start + 3]]));
    let (head, rest) = bytes[start + 4..].split_at(size);
    // Before these stand the six bytes of the format's name, and its data begin at a multiple of 64.
    assert_eq!((6 + 4 + size) % 64, 0);
    (String::from_utf8(head.to_vec()).unwrap(), rest[..24].to_vec())
}

#[test]
fn a_table_of_a_sweep_is_written_as_arrays_too() {
    let folder = std::env::temp_dir().join(format!("dalembert-arrays-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = |end: &str| folder.join(format!("table.{end}")).to_str().unwrap().to_owned();
    let (table, arrays) = (path("csv"), path("npz"));
    let sweep = ["sweep", MODEL, "--vary", "l=0.5,1,2", "--until", "0.1", "--csv", &table];
    let told = run(&[&sweep[..], &["--npz", &arrays]].concat()).unwrap();
    assert!(told.contains(&format!("written: {table}\nwritten: {arrays}\n")), "{told}");
    let bytes = fs::read(&arrays).unwrap();
    let mut rows = csv::Reader::from_path(&table).unwrap();
    let names = rows.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = rows.records().map(Result::unwrap).collect();
    for (k, name) in names.iter().enumerate().skip(1).take(names.len() - 2) {
        let (head, data) = array(&bytes, name);
        assert!(head.starts_with("{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }"), "{head}");
        let numbers: Vec<f64> = data.chunks_exact(8).map(|x| f64::from_le_bytes(x.try_into().unwrap())).collect();
        for (number, row) in numbers.iter().zip(&rows) {
            assert!(row[k].parse::<f64>().map_or(number.is_nan(), |text| text == *number), "{name}");
        }
        assert_eq!(numbers.len(), rows.len());
    }
    assert_eq!(array(&bytes, "run").1, [0_i64, 1, 2].into_iter().flat_map(i64::to_le_bytes).collect::<Vec<u8>>());
    assert!(array(&bytes, "error").0.contains("'<U1'"));
    let refused = run(&[&sweep[..], &["--npz", &path("txt")]].concat()).unwrap_err();
    assert!(refused.contains("`.npz`"), "{refused}");
    fs::remove_dir_all(folder).unwrap();
}
