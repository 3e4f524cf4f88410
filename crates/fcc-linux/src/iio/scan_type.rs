//! How a number is stored in a device's buffer, as its `..._type` says.

use core::str::FromStr;

/// How one element of a scan is stored: `[be|le]:[s|u]bits/storagebits[Xrepeat][>>shift]`
/// (Linux, `Documentation/iio/iio_devbuf.rst`).
///
/// ```
/// use fcc_linux::iio::ScanType;
///
/// // The example of the kernel's documentation: 12 bits, left in 16.
/// let twelve: ScanType = "le:s12/16>>4".parse()?;
/// assert_eq!(twelve.decode(&[0xF0, 0xFF]), Some(-1));
/// # Ok::<(), fcc_linux::iio::ScanTypeError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ScanType {
    is_big_endian: bool,
    is_signed: bool,
    /// 1 to 64, and with `shift` at most those of the storage.
    bits: u32,
    /// 8, 16, 32 or 64.
    storage_bits: u32,
    shift: u32,
}

/// The text is no type of a scan element that can be read here.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("no type of a scan element like le:s12/16>>4 with 8, 16, 32 or 64 bits of storage")]
pub struct ScanTypeError;

impl FromStr for ScanType {
    type Err = ScanTypeError;

    fn from_str(text: &str) -> Result<Self, ScanTypeError> {
        Self::parse(text.trim_end()).ok_or(ScanTypeError)
    }
}

impl ScanType {
    fn parse(text: &str) -> Option<Self> {
        let (order, rest) = text.split_once(':')?;
        let is_big_endian = match order {
            "be" => true,
            "le" => false,
            _ => return None,
        };
        let is_signed = match rest.as_bytes().first()? {
            b's' => true,
            b'u' => false,
            _ => return None,
        };
        let (bits, rest) = rest.get(1..)?.split_once('/')?;
        let (storage, shift) = rest.split_once(">>").unwrap_or((rest, "0"));
        // An element that is repeated is a vector such as a quaternion.
        let storage = storage.strip_suffix("X1").unwrap_or(storage);
        let read = Self {
            is_big_endian,
            is_signed,
            bits: number(bits)?,
            storage_bits: number(storage)?,
            shift: number(shift)?,
        };
        let fits = matches!(read.storage_bits, 8 | 16 | 32 | 64)
            && read.bits > 0
            && read.bits.saturating_add(read.shift) <= read.storage_bits;
        fits.then_some(read)
    }

    /// Bytes in the buffer, which are its alignment as well.
    pub const fn bytes(&self) -> usize {
        (self.storage_bits / 8) as usize
    }

    /// The number; `None` if there are too few bytes.
    pub fn decode(&self, stored: &[u8]) -> Option<i64> {
        let stored = stored.get(..self.bytes())?;
        let append = |all: u64, byte: &u8| all << 8 | u64::from(*byte);
        let all = if self.is_big_endian {
            stored.iter().fold(0, append)
        } else {
            stored.iter().rev().fold(0, append)
        };
        // To the top, and down again: that cuts off what is above, and extends
        // the sign.
        let above = 64 - self.bits;
        let top = (all >> self.shift) << above;
        Some(if self.is_signed {
            (top as i64) >> above
        } else {
            (top >> above) as i64
        })
    }
}

/// Decimal digits alone, without the sign that `parse` accepts.
fn number(text: &str) -> Option<u32> {
    let is_digits = text.bytes().all(|byte| byte.is_ascii_digit());
    is_digits.then(|| text.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(text: &str, bytes: &[u8]) -> i64 {
        let parsed: ScanType = text.parse().unwrap();
        parsed.decode(bytes).unwrap()
    }

    /// As drivers of the kernel have them: `inv_mpu6050` `be:s16/16>>0`, `st_sensors`
    /// `le:s12/16>>4`, `bmp280` `le:u32/32>>0`, every timestamp `le:s64/64>>0`.
    #[test]
    fn numbers_are_read_as_drivers_store_them() {
        assert_eq!(decoded("be:s16/16>>0\n", &[0x80, 0x00]), -32_768);
        assert_eq!(decoded("le:s12/16>>4", &[0xF0, 0x7F]), 2_047);
        assert_eq!(decoded("le:s12/16>>4", &[0x0F, 0x80]), -2_048);
        assert_eq!(decoded("le:u32/32>>0", &[1, 2, 0, 0xFF]), 0xFF00_0201);
        let ns = 1_234_567_890_123_456_789_i64;
        assert_eq!(decoded("le:s64/64>>0", &ns.to_le_bytes()), ns);
        assert_eq!(decoded("be:u24/32>>8", &[1, 2, 3, 0xAA]), 0x01_02_03);
        assert_eq!(decoded("le:s8/8X1", &[0xFE]), -2);
    }

    #[test]
    fn what_is_no_type_is_refused() {
        for text in [
            "",
            "le",
            "le:",
            "le:s",
            "me:s16/16",
            "le:f16/16",
            "le:s0/16>>0",
            "le:s17/16",
            "le:s16/16>>1",
            "le:s16/24",
            "le:s16/16X4>>0",
            "le:s+6/16",
            "le:s16/16>>-1",
            "le:s99999999999/16",
        ] {
            assert_eq!(text.parse::<ScanType>(), Err(ScanTypeError), "{text:?}");
        }
    }
}
