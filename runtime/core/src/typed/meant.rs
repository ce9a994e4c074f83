//! What a message about a wrong value proposes.

use plcc_abi::image::AssertType;

/// How the author of a text writes the value that he means: `2 s` as T#2s, `1,5` as 1.5, `on` as TRUE. `None`: no idea.
pub(super) fn meant(text: &str, ty: AssertType) -> Option<String> {
    let duration = |prefix: &str| plcc_literal::duration::meant_span(text).map(|span| format!("{prefix}#{span}"));
    match ty {
        AssertType::Time => duration("T"),
        AssertType::S5Time => duration("S5T"),
        AssertType::Ltime => duration("LT"),
        AssertType::Real | AssertType::Lreal => {
            let pointed = text.replace(',', ".");
            pointed.parse::<f64>().ok()?;
            let (sign, digits) = pointed.split_at(pointed.len() - pointed.trim_start_matches(['+', '-']).len());
            Some(if digits.starts_with('.') { format!("{sign}0{digits}") } else { pointed })
        }
        AssertType::Bool => ["on", "yes", "high", "off", "no", "low"]
            .iter()
            .position(|word| word.eq_ignore_ascii_case(text))
            .map(|at| if at < 3 { "TRUE" } else { "FALSE" }.to_owned()),
        AssertType::Bits(_) => {
            let digits = text.strip_prefix("0x").or_else(|| text.strip_prefix("0X"))?;
            u64::from_str_radix(digits, 16).ok().map(|_| format!("16#{digits}"))
        }
        AssertType::Signed(_)
        | AssertType::Unsigned(_)
        | AssertType::Char
        | AssertType::Wchar
        | AssertType::Date
        | AssertType::TimeOfDay
        | AssertType::Ltod
        | AssertType::Ldt
        | AssertType::DateAndTime
        | AssertType::Dtl
        | AssertType::Text
        | AssertType::WideText => None,
    }
}

pub(super) const fn example(ty: AssertType) -> &'static str {
    match ty {
        AssertType::Bool => "TRUE or FALSE",
        AssertType::Bits(_) => "16#FF",
        AssertType::Signed(_) => "-5",
        AssertType::Unsigned(_) => "5",
        AssertType::Real | AssertType::Lreal => "12.5",
        AssertType::Char | AssertType::Wchar => "'a'",
        AssertType::S5Time => "S5T#1s500ms",
        AssertType::Time => "T#1s500ms",
        AssertType::Ltime => "LT#1s500us",
        AssertType::Date => "D#2026-01-31",
        AssertType::TimeOfDay => "TOD#6:00:00",
        AssertType::Ltod => "LTOD#6:00:00",
        AssertType::Ldt => "LDT#2026-01-31-6:00:00",
        AssertType::DateAndTime => "DT#2026-01-31-6:00:00",
        AssertType::Dtl => "DTL#2026-01-31-6:00:00",
        AssertType::Text | AssertType::WideText => "'abc'",
    }
}
