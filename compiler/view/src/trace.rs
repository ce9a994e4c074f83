//! Traces, as `--trace FILE.csv` writes them.

use std::collections::HashMap;

use crate::names::{Names, Scope, is_cell};

/// Values over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Names of the columns as written, without type and unit; and their keys.
    pub columns: Vec<(String, String)>,
    /// Units of the columns; empty if they have none.
    pub units: Vec<String>,
    /// Milliseconds and values.
    pub rows: Vec<(f64, Vec<String>)>,
}

impl Trace {
    /// Reads a trace. `Err`: why the text is not a trace.
    pub fn parse(text: &str, names: &Names) -> Result<Trace, String> {
        let mut lines = text.lines();
        let header = fields(lines.next().unwrap_or_default());
        let time = header.iter().position(|name| name == "time_ms").ok_or("it has no column `time_ms`")?;
        let is_value = |at: usize| at != time && header[at] != "cycle";
        let mut trace = Trace::default();
        for (_, name) in header.iter().enumerate().filter(|(at, _)| is_value(*at)) {
            let (name, key, unit) = column(name, names);
            trace.columns.push((name.to_string(), key));
            trace.units.push(unit.to_string());
        }
        for (number, line) in lines.enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let row = fields(line);
            let ms = row.get(time).and_then(|text| text.parse().ok()).filter(|ms: &f64| ms.is_finite());
            let ms = ms.ok_or_else(|| format!("line {} has no time", number + 2))?;
            let value = |at: usize| row.get(at).cloned().unwrap_or_default();
            let values = (0..header.len()).filter(|at| is_value(*at)).map(value).collect();
            trace.rows.push((ms, values));
        }
        if trace.rows.is_empty() { Err("it has no values".to_string()) } else { Ok(trace) }
    }

    /// The last row that is not later than a time in milliseconds; without a time the last row.
    pub fn row(&self, ms: Option<f64>) -> usize {
        let later = ms.map_or(self.rows.len(), |ms| self.rows.partition_point(|(time, _)| *time <= ms));
        later.saturating_sub(1)
    }

    /// The values at a time in milliseconds, by key: those of the last row that is not later. Without a time the last row.
    pub fn at(&self, ms: Option<f64>) -> HashMap<String, String> {
        let Some((_, values)) = self.rows.get(self.row(ms)) else { return HashMap::new() };
        self.columns.iter().zip(values).map(|((_, key), value)| (key.clone(), value.clone())).collect()
    }
}

/// The name of a column without type and unit, its key, and its unit. A tag may be called `Pump in use`.
fn column<'a>(text: &'a str, names: &Names) -> (&'a str, String, &'a str) {
    // Names of columns have no quotes, even if they need them in a program.
    let key = |name: &str| {
        let quoted = || names.key(&format!("\"{name}\""), Scope::default());
        names.key(name, Scope::default()).or_else(quoted)
    };
    if let Some(key) = key(text) {
        return (text, key, "");
    }
    let (name, unit) = text.rsplit_once(" in ").unwrap_or((text, ""));
    let name = name.rsplit_once(" as ").map_or(name, |(name, _)| name);
    // The current value of a timer or counter: `Delay.VALUE`.
    let value = name.strip_suffix(".VALUE").and_then(key).filter(|key| is_cell(key));
    let value = value.map(|key| format!("{key}.VALUE"));
    (name, value.or_else(|| key(name)).unwrap_or_else(|| name.to_string()), unit)
}

/// Fields of a line of CSV.
fn fields(line: &str) -> Vec<String> {
    let mut list = vec![String::new()];
    let mut quoted = false;
    let mut chars = line.trim_end_matches('\r').chars().peekable();
    while let Some(c) = chars.next() {
        let field = list.last_mut().expect("there is a field from the beginning");
        match c {
            '"' if quoted && chars.peek() == Some(&'"') => {
                chars.next();
                field.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => list.push(String::new()),
            c => field.push(c),
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_found_by_address_and_time() {
        let text = "cycle,time_ms,I0.0,\"a,b\",Level as REAL in %\n0,0,0,1,5\n1,10,1,1,6.5\n";
        let trace = Trace::parse(text, &Names::default()).expect("it is a trace");
        assert_eq!(trace.units, ["", "", "%"]);
        assert_eq!(trace.at(Some(5.0)).get("I0.0").map(String::as_str), Some("0"));
        assert_eq!(trace.at(Some(10.0)).get("I0.0").map(String::as_str), Some("1"));
        assert_eq!(trace.at(None).get("Level").map(String::as_str), Some("6.5"));
        assert!(Trace::parse("a,b\n1,2\n", &Names::default()).is_err());
    }
}
