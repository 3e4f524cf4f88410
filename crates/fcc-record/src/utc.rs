//! Dates in UTC.

/// Nanoseconds in a second.
pub(crate) const SECOND_NS: u64 = 1_000_000_000;

/// Date and time of day in UTC, in the Gregorian calendar.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Date {
    year: u64,
    month: u64,
    day: u64,
    hour: u64,
    minute: u64,
    second: u64,
    millisecond: u64,
}

/// After H. Hinnant, "chrono-compatible low-level date algorithms" (2013): days
/// are counted from 1 March of the year 0, so that the leap day ends a year.
fn date(unix_ns: u64) -> Date {
    let seconds = unix_ns / SECOND_NS;
    let days = seconds / 86_400 + 719_468;
    let era = days / 146_097;
    let day_of_era = days % 146_097;
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let month = if month_from_march < 10 {
        month_from_march + 3
    } else {
        month_from_march - 9
    };
    Date {
        year: year_of_era + era * 400 + u64::from(month <= 2),
        month,
        day: day_of_year - (153 * month_from_march + 2) / 5 + 1,
        hour: seconds / 3_600 % 24,
        minute: seconds / 60 % 60,
        second: seconds % 60,
        millisecond: unix_ns % SECOND_NS / 1_000_000,
    }
}

/// `2026-11-20T04:21:33Z`; nanoseconds since 1970 in UTC.
pub fn timestamp(unix_ns: u64) -> String {
    let d = date(unix_ns);
    format!(
        "{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z",
        d.year, d.month, d.day, d.hour, d.minute, d.second
    )
}

/// `2026-11-20T04-21-33.512Z`: sorts by date, and is valid in every file
/// system.
pub(super) fn file_stamp(unix_ns: u64) -> String {
    let d = date(unix_ns);
    format!(
        "{:04}-{:02}-{:02}T{:02}-{:02}-{:02}.{:03}Z",
        d.year, d.month, d.day, d.hour, d.minute, d.second, d.millisecond
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `date -u -d @N` of GNU coreutils prints them.
    #[test]
    fn dates_are_the_calendars() {
        for (seconds, printed) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_000_000_000, "2001-09-09T01:46:40Z"),
            (1_709_251_199, "2024-02-29T23:59:59Z"),
            (1_795_148_493, "2026-11-20T04:21:33Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(timestamp(seconds * SECOND_NS), printed);
        }
        assert_eq!(
            file_stamp(1_795_148_493_512_345_678),
            "2026-11-20T04-21-33.512Z"
        );
    }
}
