//! A chart for each qualifier and event of GRAPH: two steps that take turns, with one action in the first.

use plcc_syntax::chart::ast::{Event, Qualifier};

use super::Row;

/// Rows by qualifier, then by event, and a chart without an action.
pub fn rows() -> Vec<Row> {
    let mut rows = vec![Row::new("GRAPH", "no action", "")];
    for qualifier in Qualifier::ALL {
        let name = qualifier.name();
        let action = match qualifier {
            Qualifier::N | Qualifier::S | Qualifier::R => format!("M{{p}}.0 ({name})"),
            Qualifier::D | Qualifier::L => format!("M{{p}}.0, T#20MS ({name})"),
            Qualifier::On | Qualifier::Off => format!("S2 (S1_{name})"),
            Qualifier::Cs => "C{n} := C#20 (S1_CS)".to_string(),
            Qualifier::Cu | Qualifier::Cd | Qualifier::Cr => format!("C{{n}} (S1_{name})"),
            Qualifier::Tl | Qualifier::Td => format!("T{{n}}, S5T#100MS (S1_{name})"),
            Qualifier::Tf => "T{n} := S5T#100MS (TF)".to_string(),
            Qualifier::Tr => "T{n} (S1_TR)".to_string(),
        };
        rows.push(Row::new("GRAPH", name, &action));
    }
    rows.extend(Event::ALL.map(|event| Row::new("GRAPH", event.name(), &format!("M{{p}}.1 ({}_S)", event.name()))));
    rows
}

/// A CPU that runs the charts, and their sources: function n calls the chart of the same number.
pub fn sources(blocks: Vec<(usize, String)>, mut main: String) -> (&'static str, Vec<(&'static str, String)>) {
    let mut charts = String::new();
    main.push_str(&super::program::function(1, ""));
    for (number, action) in blocks {
        charts.push_str(&format!(
            "FUNCTION_BLOCK FB {number}
(*$_CMPSET
   FBInterface: Minimum
*)
INITIAL_STEP S1 (*$_NUM 1*):
{action}
END_STEP
STEP S2 (*$_NUM 2*):
END_STEP
TRANSITION T1 (*$_NUM 1*)
  FROM S1
  TO S2
CONDITION := M0.0
END_TRANSITION
TRANSITION T2 (*$_NUM 2*)
  FROM S2
  TO S1
CONDITION := M1.1
END_TRANSITION
END_FUNCTION_BLOCK
"
        ));
        main.push_str(&format!("DATA_BLOCK DB {number}\nFB {number}\nBEGIN\nEND_DATA_BLOCK\n"));
        main.push_str(&super::program::function(number, &format!("CALL FB {number}, DB {number} (INIT_SQ := FALSE)")));
    }
    ("s7-300", vec![("charts.gr7", charts), ("main.stl", main)])
}
