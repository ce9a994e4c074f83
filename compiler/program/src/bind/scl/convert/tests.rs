//! Expected conversions are those of the SCL reference, types and conversions.

use plcc_diag::Span;

use super::*;

const ALL_RULES: [Rules; 4] = [Rules::Classic, Rules::Tia300, Rules::Tia1200, Rules::Tia1500];

const CUT: Conversion = Conversion::Bits { checked: true };
const BITS: Conversion = Conversion::Bits { checked: false };

#[test]
fn each_implicit_conversion_is_an_explicit_one() {
    for rules in ALL_RULES {
        for from in Elementary::ALL {
            for to in Elementary::ALL {
                let value = Expr { kind: ExprKind::Const(0), ty: from, span: Span::default() };
                if implicit(rules, false, from, to) != Implicit::No {
                    assert!(explicit_expr(rules, value, to).is_some(), "{rules:?}: {} to {}", from.name(), to.name());
                }
            }
        }
    }
}

#[test]
fn what_is_strict_is_also_relaxed() {
    for rules in ALL_RULES {
        for from in Elementary::ALL {
            for to in Elementary::ALL {
                if implicit(rules, true, from, to) == Implicit::Yes {
                    assert_eq!(implicit(rules, false, from, to), Implicit::Yes);
                }
            }
        }
    }
}

#[test]
fn implicit_by_dialect() {
    let find = |rules, from, to| implicit(rules, false, from, to);
    assert_eq!(find(Rules::Classic, Bool, Word), Implicit::Yes);
    assert_eq!(find(Rules::Tia1500, Bool, Word), Implicit::No);
    assert_eq!(find(Rules::Classic, Int, Real), Implicit::Yes);
    assert_eq!(find(Rules::Classic, Word, Int), Implicit::Unusual);
    assert_eq!(find(Rules::Tia300, Word, Int), Implicit::Yes);
    assert_eq!(implicit(Rules::Tia300, true, Word, Int), Implicit::No);
    assert_eq!(find(Rules::Tia300, Dint, Int), Implicit::No);
    assert_eq!(find(Rules::Tia1200, Dint, Int), Implicit::Yes);
    assert_eq!(find(Rules::Tia1500, Real, Int), Implicit::Yes);
    assert_eq!(find(Rules::Tia1500, Real, Time), Implicit::No);
    assert_eq!(find(Rules::Tia1500, Int, Bool), Implicit::No);
    // A type that an S7-300 lacks behaves as on CPUs that have it.
    assert_eq!(find(Rules::Classic, Usint, Int), Implicit::Yes);
}

#[test]
fn losses() {
    assert!(narrows(Dint, Int));
    assert!(narrows(Int, Uint));
    assert!(narrows(Uint, Int));
    assert!(!narrows(Usint, Int));
    assert!(!narrows(Word, Int));
    assert!(!narrows(Dint, Real));
    assert!(narrows(Real, Dint));
    assert!(narrows(Lreal, Real));
    assert!(narrows(Time, Udint) && !narrows(Time, Dint));
    assert!(narrows(Dint, TimeOfDay) && !narrows(TimeOfDay, Dint));
    assert!(narrows(Int, Date) && narrows(Date, Int) && !narrows(Uint, Date) && !narrows(Date, Uint));
    assert!(narrows(Udint, Time) && !narrows(Dint, Time) && narrows(Time, TimeOfDay) && !narrows(TimeOfDay, Time));
    assert!(narrows(Sint, Char) && !narrows(Usint, Char) && !narrows(Char, Sint));
    assert!(holds(Rules::Tia1500, Dint, TimeOfDay, 86_399_999) && !holds(Rules::Tia1500, Dint, TimeOfDay, 86_400_000));
    assert!(holds(Rules::Tia1500, Udint, Time, 5) && !holds(Rules::Tia1500, Udint, Time, 1 << 31));
}

#[test]
fn what_conversions_compute() {
    let tia = |from, to| explicit(Rules::Tia1500, from, to);
    let classic = |from, to| explicit(Rules::Classic, from, to);
    assert_eq!(tia(Int, Int), None);
    assert_eq!(tia(Bool, Int), Some(BITS));
    assert_eq!(tia(Word, Bool), Some(Conversion::ToBool));
    assert_eq!(tia(Byte, Int), Some(BITS));
    assert_eq!(tia(Word, Int), Some(BITS));
    assert_eq!(tia(Dword, Int), Some(CUT));
    assert_eq!(tia(Int, Byte), Some(CUT));
    assert_eq!(tia(Int, Dword), Some(CUT));
    assert_eq!(classic(Int, Dword), Some(BITS));
    assert_eq!(classic(Int, Byte), Some(CUT));
    assert_eq!(tia(Dint, Int), Some(Conversion::Value(Overflow::LowBits)));
    assert_eq!(classic(Real, Int), Some(Conversion::Value(Overflow::Pattern)));
    assert_eq!(tia(Real, Dword), Some(BITS));
    assert_eq!(tia(Real, Word), None);
    assert_eq!(tia(Real, Time), None);
    assert_eq!(tia(Real, Bool), None);
    assert_eq!(tia(Time, Dint), Some(BITS));
    assert_eq!(tia(Time, Udint), Some(Conversion::Value(Overflow::LowBits)));
    assert_eq!(tia(Dint, TimeOfDay), Some(Conversion::Ranged { max: 86_399_999 }));
    assert_eq!(tia(Lint, Ltod), Some(Conversion::Ranged { max: 86_399_999_999_999 }));
    assert_eq!(tia(Ltime, Ldt), Some(TO_LDT));
    assert_eq!(tia(Ldt, Ltime), Some(BITS));
    assert_eq!(tia(Date, Int), Some(Conversion::Ranged { max: 32_767 }));
    assert_eq!(tia(Char, Int), Some(BITS));
    assert_eq!(tia(Int, Char), Some(CUT));
    assert_eq!(tia(S5Time, Time), Some(Conversion::FromS5Time));
}

#[test]
fn conversions_by_name() {
    assert_eq!(pair("TOD_TO_DINT"), Some((TimeOfDay, Dint)));
    assert_eq!(pair("INT_TO_STRING"), None);
    assert_eq!(bcd(Rules::Classic, "BCD_TO_INT"), Some((Word, Conversion::FromBcd { fault: true }, Int)));
    assert_eq!(bcd(Rules::Tia1500, "DINT_TO_BCD"), Some((Dint, Conversion::ToBcd, Dword)));
    assert_eq!(rounding(Rules::Classic, "TRUNC"), Some(Conversion::Truncate(Overflow::Pattern)));
    assert_eq!(rounding(Rules::Classic, "SIN"), None);
}
