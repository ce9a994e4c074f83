//! Dates and times of day.

/// A day of the calendar. [`Date::exists`] checks whether it exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Date {
    pub year: u32,
    pub month: u32,
    pub day: u32,
}

/// A time of day. [`Clock::exists`] checks whether it exists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clock {
    pub hour: u32,
    pub minute: u32,
    pub second: u32,
    pub ns: u32,
}

impl Date {
    /// Reads `2000-6-20`; `None`: not three numbers.
    pub fn parse(text: &str) -> Option<Date> {
        let [year, month, day] = fields(text, '-')?;
        Some(Date { year, month, day })
    }

    /// Whether the calendar has this day.
    pub fn exists(self) -> bool {
        (1..=12).contains(&self.month) && (1..=days_of_month(self.year, self.month)).contains(&self.day)
    }

    /// Days since the first of January of `epoch`; `None`: before it, or not in the calendar.
    pub fn days_since(self, epoch: u32) -> Option<u32> {
        if self.year < epoch || self.year > 9999 || !self.exists() {
            return None;
        }
        let years: u32 = (epoch..self.year).map(|year| if leap(year) { 366 } else { 365 }).sum();
        let months: u32 = (1..self.month).map(|month| days_of_month(self.year, month)).sum();
        Some(years + months + self.day - 1)
    }

    /// Day of the week from 1, a Sunday; `None` before 1970.
    pub fn weekday(self) -> Option<u8> {
        // 1970-01-01 was a Thursday.
        self.days_since(1970).map(|days| ((days + 4) % 7 + 1) as u8)
    }
}

impl Clock {
    /// Reads `5:45:00`, `5:45:00.5`, cut off after nanoseconds; `None`: not three numbers, or a fraction without digits.
    pub fn parse(text: &str) -> Option<Clock> {
        let (time, fraction) = text.split_once('.').unwrap_or((text, "0"));
        let [hour, minute, second] = fields(time, ':')?;
        let digits = fraction.bytes().filter(|byte| *byte != b'_');
        if digits.clone().next().is_none() || !digits.clone().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        let ns = digits.chain(*b"00000000").take(9).fold(0, |ns, digit| ns * 10 + u32::from(digit - b'0'));
        Some(Clock { hour, minute, second, ns })
    }

    /// Whether a day has this time.
    pub fn exists(self) -> bool {
        self.hour < 24 && self.minute < 60 && self.second < 60
    }

    /// Milliseconds since midnight, of a time that exists; parts of a millisecond are cut off.
    pub fn milliseconds(self) -> u32 {
        ((self.hour * 60 + self.minute) * 60 + self.second) * 1000 + self.ns / 1_000_000
    }

    /// Nanoseconds since midnight, of a time that exists.
    pub fn nanoseconds(self) -> u64 {
        u64::from((self.hour * 60 + self.minute) * 60 + self.second) * 1_000_000_000 + u64::from(self.ns)
    }
}

fn leap(year: u32) -> bool {
    year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400)
}

fn days_of_month(year: u32, month: u32) -> u32 {
    match month {
        4 | 6 | 9 | 11 => 30,
        2 if leap(year) => 29,
        2 => 28,
        _ => 31,
    }
}

/// Exactly three unsigned numbers with `separator` between them, blanks around them allowed.
fn fields(text: &str, separator: char) -> Option<[u32; 3]> {
    let mut numbers = [0; 3];
    let mut parts = text.split(separator);
    for number in &mut numbers {
        let part = parts.next()?.trim();
        if part.is_empty() || part.len() > 6 || !part.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        *number = part.parse().ok()?;
    }
    parts.next().is_none().then_some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates() {
        let days = |text: &str| Date::parse(text).and_then(|date| date.days_since(1990));
        assert_eq!(days("1990-1-1"), Some(0));
        assert_eq!(days("2000 - 06 - 20"), Some(3823));
        assert_eq!(days("2000-2-29"), Some(3711));
        for text in ["1900-2-29", "2001-2-29", "1990-13-1", "1989-12-31", "1990-1", "1990-1-1-1", "1990--1", "a-1-1"] {
            assert_eq!(days(text), None, "{text}");
        }
        assert_eq!(Date::parse("2024-5-6").and_then(Date::weekday), Some(2));
        assert_eq!(Date::parse("999999-1-1").and_then(|date| date.days_since(1970)), None);
    }

    #[test]
    fn times_of_day() {
        let ms = |text: &str| Clock::parse(text).filter(|clock| clock.exists()).map(Clock::milliseconds);
        assert_eq!(ms("5:45:00.5"), Some(20_700_500));
        assert_eq!(ms("23:59:59.9999"), Some(86_399_999));
        assert_eq!(Clock::parse("0:0:0.000_000_001").map(Clock::nanoseconds), Some(1));
        for text in ["24:0:0", "0:60:0", "0:0", "0:0:0.", "0:0:0.x", "-1:0:0"] {
            assert_eq!(ms(text), None, "{text}");
        }
    }
}
