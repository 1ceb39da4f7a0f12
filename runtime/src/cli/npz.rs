//! Archives of NumPy's arrays (NumPy, A simple file format for NumPy arrays, version 1.0).

use super::zip;

/// Arrays by their names.
#[derive(Default)]
pub struct Archive(Vec<(String, Vec<u8>)>);

impl Archive {
    /// Adds numbers, row by row.
    pub fn numbers(&mut self, name: &str, shape: &[usize], values: impl Iterator<Item = f64>) {
        self.add(name, "<f8", shape, values.flat_map(f64::to_le_bytes).collect());
    }

    /// Adds a list of whole numbers.
    pub fn whole(&mut self, name: &str, values: &[i64]) {
        self.add(name, "<i8", &[values.len()], values.iter().flat_map(|x| x.to_le_bytes()).collect());
    }

    /// Adds a list of words.
    pub fn words(&mut self, name: &str, words: &[&str]) {
        let longest = words.iter().map(|word| word.chars().count()).max().unwrap_or(0).max(1);
        let padded = |word: &&str| {
            let letters = word.chars().map(u32::from).chain(std::iter::repeat(0)).take(longest);
            letters.flat_map(u32::to_le_bytes).collect::<Vec<u8>>()
        };
        self.add(name, &format!("<U{longest}"), &[words.len()], words.iter().flat_map(padded).collect());
    }

    fn add(&mut self, name: &str, kind: &str, shape: &[usize], data: Vec<u8>) {
        let sizes: String = shape.iter().map(|size| format!("{size}, ")).collect();
        let mut head = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}", sizes.trim_end());
        // The data begin at a multiple of 64 bytes, after a magic string of 6, a version of 2 and a length of 2.
        while !(10 + head.len() + 1).is_multiple_of(64) {
            head.push(' ');
        }
        head.push('\n');
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((head.len() as u16).to_le_bytes());
        bytes.extend(head.bytes());
        bytes.extend(data);
        self.0.push((format!("{name}.npy"), bytes));
    }

    /// The file; `None` where there is more than its sizes of 32 bits and its count of 16 can tell.
    pub fn bytes(&self) -> Option<Vec<u8>> {
        // Beside an array stand its name, twice, and two records of 76 bytes in all.
        let size: u64 = self.0.iter().map(|(name, bytes)| (2 * name.len() + bytes.len() + 76) as u64).sum();
        let fits = size < u64::from(u32::MAX) && self.0.len() < usize::from(u16::MAX);
        fits.then(|| zip::stored(&self.0))
    }
}
