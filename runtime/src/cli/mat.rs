//! Variables as MATLAB keeps them (The MathWorks, MAT-File Format, level 5), uncompressed: Octave and SciPy read them too.

/// Kinds of data.
const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const UTF16: u32 = 17;

/// Classes of arrays.
const CELLS: u32 = 1;
const LETTERS: u32 = 4;
const NUMBERS: u32 = 6;

/// Variables, one after the other.
#[derive(Default)]
pub struct Variables(Vec<u8>);

impl Variables {
    /// Adds a matrix, whose values stand column by column.
    pub fn numbers(&mut self, name: &str, shape: [usize; 2], values: &[f64]) {
        let data: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.0.extend(array(NUMBERS, name, shape, &element(DOUBLE, &data)));
    }

    /// Adds a list of words: a row of cells.
    pub fn words(&mut self, name: &str, words: &[&str]) {
        let cells: Vec<u8> = words.iter().flat_map(|word| letters(word)).collect();
        self.0.extend(array(CELLS, name, [1, words.len()], &cells));
    }

    /// The file; `None` where there is more than its sizes of 32 bits can tell.
    pub fn bytes(self) -> Option<Vec<u8>> {
        // A text of 116 bytes, no data of subsystems, the version, and in which order bytes stand.
        let mut out = format!("{:<116}", "MATLAB 5.0 MAT-file, written by dalembert").into_bytes();
        out.extend([0; 8]);
        out.extend(0x0100_u16.to_le_bytes());
        out.extend(b"IM");
        out.extend(self.0);
        u32::try_from(out.len()).is_ok().then_some(out)
    }
}

/// Data with their kind and size, filled up to a multiple of eight bytes.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut out = [kind, data.len() as u32].map(u32::to_le_bytes).concat();
    out.extend(data);
    out.resize(out.len().next_multiple_of(8), 0);
    out
}

/// An array of elements.
fn array(class: u32, name: &str, shape: [usize; 2], elements: &[u8]) -> Vec<u8> {
    let flags = [class, 0].map(u32::to_le_bytes).concat();
    let shape = shape.map(|size| (size as u32).to_le_bytes()).concat();
    let head = [element(UINT32, &flags), element(INT32, &shape), element(INT8, name.as_bytes())].concat();
    element(MATRIX, &[&head, elements].concat())
}

/// A word in a cell, which has no name.
fn letters(word: &str) -> Vec<u8> {
    let data: Vec<u8> = word.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let count = data.len() / 2;
    array(LETTERS, "", [count.min(1), count], &element(UTF16, &data))
}

#[cfg(test)]
mod tests {
    use super::Variables;

    /// What follows the head of 128 bytes, in words of 32 bits.
    fn written(variables: Variables) -> Vec<u32> {
        let bytes = variables.bytes().expect("a small file");
        assert!(bytes.starts_with(b"MATLAB 5.0 MAT-file"));
        // Eight bytes that say where data of subsystems are, the version, and the order of bytes.
        assert_eq!(&bytes[116..128], b"\0\0\0\0\0\0\0\0\x00\x01IM");
        bytes[128..].chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().expect("four bytes"))).collect()
    }

    #[test]
    fn a_matrix_stands_column_by_column() {
        let mut variables = Variables::default();
        variables.numbers("B", [2, 1], &[1.0, -2.0]);
        let letter = u32::from(b'B');
        let head = [14, 72, 6, 8, 6, 0, 5, 8, 2, 1, 1, 1, letter, 0];
        assert_eq!(written(variables), [&head[..], &[9, 16, 0, 0x3ff0_0000, 0, 0xc000_0000]].concat());
    }

    #[test]
    fn words_are_cells_of_letters() {
        let mut variables = Variables::default();
        variables.words("names", &["θ'", ""]);
        let name = [0x656d_616e, u32::from(b's')];
        let head = [14, 168, 6, 8, 1, 0, 5, 8, 1, 2, 1, 5, name[0], name[1]];
        let word = [14, 56, 6, 8, 4, 0, 5, 8, 1, 2, 1, 0, 17, 4, 0x0027_03b8, 0];
        let none = [14, 48, 6, 8, 4, 0, 5, 8, 0, 0, 1, 0, 17, 0];
        assert_eq!(written(variables), [&head[..], &word, &none].concat());
    }
}
