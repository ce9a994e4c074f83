//! Durations, dates and times of day as text, which reads back to the same value.

/// Days from 1970-01-01 to 1990-01-01.
pub const DAYS_TO_1990: i64 = 7305;
const NS_PER_DAY: i64 = 86_400_000_000_000;

/// `1D2H3M4S5MS`, for a duration in nanoseconds.
pub fn duration(ns: i128) -> String {
    let units: [(i128, &str); 7] = [
        (86_400_000_000_000, "D"),
        (3_600_000_000_000, "H"),
        (60_000_000_000, "M"),
        (1_000_000_000, "S"),
        (1_000_000, "MS"),
        (1_000, "US"),
        (1, "NS"),
    ];
    let mut rest = ns.abs();
    let mut text = String::from(if ns < 0 { "-" } else { "" });
    for (size, unit) in units {
        if rest >= size {
            text.push_str(&format!("{}{unit}", rest / size));
            rest %= size;
        }
    }
    if ns == 0 {
        text.push_str("0MS");
    }
    text
}

/// `1990-01-01`, for the number of days since 1970-01-01. Source: chrono-Compatible Low-Level Date Algorithms.
pub fn date(days: i64) -> String {
    let shifted = days + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    format!("{year}-{month:02}-{day:02}")
}

/// `05:45:00.123`, for nanoseconds since midnight.
pub fn time_of_day(ns: u64) -> String {
    let seconds = ns / 1_000_000_000;
    let mut text = format!("{:02}:{:02}:{:02}", seconds / 3_600, seconds / 60 % 60, seconds % 60);
    let fraction = format!("{:09}", ns % 1_000_000_000);
    let fraction = fraction.trim_end_matches('0');
    if !fraction.is_empty() {
        text.push_str(&format!(".{fraction:0<3}"));
    }
    text
}

/// `2024-02-29-05:45:00`, for nanoseconds since 1970-01-01.
pub fn date_and_time(ns: i64) -> String {
    let (days, rest) = (ns.div_euclid(NS_PER_DAY), ns.rem_euclid(NS_PER_DAY));
    format!("{}-{}", date(days), time_of_day(rest.unsigned_abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_in_their_units() {
        assert_eq!(duration(3_723_000_000_000), "1H2M3S");
        assert_eq!(duration(-1_000_500_000), "-1S500US");
        assert_eq!(duration(0), "0MS");
        assert_eq!(date(DAYS_TO_1990), "1990-01-01");
        assert_eq!(date(19_782), "2024-02-29");
        assert_eq!(time_of_day(45_000_500_000_000), "12:30:00.500");
        assert_eq!(date_and_time(-1), "1969-12-31-23:59:59.999999999");
    }
}
