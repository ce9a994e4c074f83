//! Timers and counters of the system: their components with start values have no declaration in the sources.

use plcc_diag::Span;
use plcc_syntax::ast::{TypeKind, TypeRef, Variable};

/// Their types, and the type of their time or count.
const TYPES: [(&str, &[&str]); 11] = [
    ("TIME", &["IEC_TIMER", "TON_TIME", "TOF_TIME", "TP_TIME", "TONR_TIME", "TON", "TOF", "TP", "TONR"]),
    ("TIME", &["TON_IEC", "TOF_IEC", "TP_IEC"]),
    ("LTIME", &["IEC_LTIMER", "TON_LTIME", "TOF_LTIME", "TP_LTIME", "TONR_LTIME"]),
    ("SINT", &["IEC_SCOUNTER", "CTU_SINT", "CTD_SINT", "CTUD_SINT"]),
    ("INT", &["IEC_COUNTER", "CTU_INT", "CTD_INT", "CTUD_INT", "CTU", "CTD", "CTUD"]),
    ("DINT", &["IEC_DCOUNTER", "CTU_DINT", "CTD_DINT", "CTUD_DINT"]),
    ("LINT", &["IEC_LCOUNTER", "CTU_LINT", "CTD_LINT", "CTUD_LINT"]),
    ("USINT", &["IEC_USCOUNTER", "CTU_USINT", "CTD_USINT", "CTUD_USINT"]),
    ("UINT", &["IEC_UCOUNTER", "CTU_UINT", "CTD_UINT", "CTUD_UINT"]),
    ("UDINT", &["IEC_UDCOUNTER", "CTU_UDINT", "CTD_UDINT", "CTUD_UDINT"]),
    ("ULINT", &["IEC_ULCOUNTER", "CTU_ULINT", "CTD_ULINT", "CTUD_ULINT"]),
];

/// The folded names of all types, each with its components.
pub fn members() -> impl Iterator<Item = (String, Vec<Variable>)> {
    TYPES.iter().flat_map(|(of, names)| names.iter().map(move |name| (name.to_lowercase(), components(of))))
}

fn components(of: &str) -> Vec<Variable> {
    let (bits, values): (&[&str], &[&str]) = match of {
        "TIME" | "LTIME" => (&["IN", "Q", "R"], &["PT", "ET"]),
        _ => (&["CU", "CD", "R", "LD", "QU", "QD"], &["PV", "CV"]),
    };
    let bits = bits.iter().map(|name| component(name, "BOOL"));
    bits.chain(values.iter().map(|name| component(name, of))).collect()
}

/// The folded name of the type of a date with time, and its components.
///
/// Source: S7-1200 reference, data type DTL.
pub fn moment() -> (String, Vec<Variable>) {
    let small = ["MONTH", "DAY", "WEEKDAY", "HOUR", "MINUTE", "SECOND"].map(|name| component(name, "USINT"));
    let components = [component("YEAR", "UINT")].into_iter().chain(small).chain([component("NANOSECOND", "UDINT")]);
    ("dtl".to_string(), components.collect())
}

fn component(name: &str, ty: &str) -> Variable {
    let ty = TypeRef { kind: TypeKind::Named(ty.to_string()), span: Span::default() };
    Variable::new(name, ty, Span::default())
}
