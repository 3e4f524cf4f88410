//! Where the elements of a scan are in the bytes of a buffer.

use super::ScanType;

/// One element of a scan, and where it is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Element {
    /// Which channel it is; the caller's number.
    pub channel: usize,
    /// How it is stored.
    pub stored: ScanType,
    /// From where, in bytes.
    offset: usize,
}

impl Element {
    /// The number in a scan; `None` if the scan is too short.
    pub fn decode(&self, scan: &[u8]) -> Option<i64> {
        self.stored.decode(scan.get(self.offset..)?)
    }
}

/// The layout of a scan: its elements in the order of their index, each aligned
/// to its own size, and the whole to the largest of them (Linux,
/// `iio_compute_scan_bytes`).
#[derive(Clone, PartialEq, Debug)]
pub struct ScanLayout {
    elements: Vec<Element>,
    bytes: usize,
}

impl ScanLayout {
    /// The layout of elements: each the index in the scan, the caller's number,
    /// and how it is stored.
    pub fn new(mut enabled: Vec<(u32, usize, ScanType)>) -> Self {
        enabled.sort_by_key(|(index, ..)| *index);
        let (mut end, mut largest) = (0_usize, 1);
        let elements = enabled
            .into_iter()
            .map(|(_, channel, stored)| {
                let offset = end.next_multiple_of(stored.bytes());
                end = offset + stored.bytes();
                largest = largest.max(stored.bytes());
                Element {
                    channel,
                    stored,
                    offset,
                }
            })
            .collect();
        Self {
            elements,
            bytes: end.next_multiple_of(largest),
        }
    }

    /// Bytes of one scan, with its padding.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// The elements, in their order.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three axes of 16 bits and a timestamp: 16 bytes, of which two are padding
    /// (Linux, `Documentation/iio/iio_devbuf.rst` and `iio_generic_buffer.c`).
    #[test]
    fn a_timestamp_is_aligned_to_eight_bytes() {
        let axis: ScanType = "be:s16/16>>0".parse().unwrap();
        let time: ScanType = "le:s64/64>>0".parse().unwrap();
        let layout = ScanLayout::new(vec![(9, 3, time), (1, 1, axis), (0, 0, axis), (2, 2, axis)]);
        assert_eq!(layout.bytes(), 16);
        let mut scan = [0; 16];
        scan[..6].copy_from_slice(&[0, 1, 0, 2, 0xFF, 0xFF]);
        scan[8..].copy_from_slice(&5_i64.to_le_bytes());
        let read = |element: &Element| (element.channel, element.decode(&scan).unwrap());
        let all: Vec<_> = layout.elements().iter().map(read).collect();
        assert_eq!(all, [(0, 1), (1, 2), (2, -1), (3, 5)]);
    }

    /// 32 bits after 16 leave two bytes empty, and 16 at the end two more.
    #[test]
    fn the_whole_is_aligned_to_its_largest_element() {
        let [small, large] = ["le:s16/16>>0", "le:u32/32>>0"].map(|text| text.parse().unwrap());
        let layout = ScanLayout::new(vec![(0, 0, small), (1, 1, large), (2, 2, small)]);
        assert_eq!(layout.bytes(), 12);
        assert_eq!(
            layout.elements()[1].decode(&[0, 0, 9, 9, 1, 0, 0, 0, 0, 0, 0, 0]),
            Some(1)
        );
    }
}
