//! Parameter types of STL (timers, counters, blocks, POINTER, ANY), handed on from block to block.
//!
//! A chain of one to three blocks hands the parameter on; the last one uses it.

use std::fmt::Write as _;

use super::{Case, Refusal, campaign};

/// A block of the chain: how it is called, and the section of its parameter.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Link {
    FcIn,
    FcOut,
    FcInOut,
    FbIn,
    FbInOut,
    OwnIn,
    OwnInOut,
}

use Link::{FbIn, FbInOut, FcIn, FcInOut, FcOut, OwnIn, OwnInOut};

const LINKS: [Link; 7] = [FcIn, FcOut, FcInOut, FbIn, FbInOut, OwnIn, OwnInOut];

impl Link {
    fn is_function(self) -> bool {
        matches!(self, FcIn | FcOut | FcInOut)
    }

    fn is_own(self) -> bool {
        matches!(self, OwnIn | OwnInOut)
    }

    fn section(self) -> &'static str {
        match self {
            FcIn | FbIn | OwnIn => "VAR_INPUT",
            FcOut => "VAR_OUTPUT",
            FcInOut | FbInOut | OwnInOut => "VAR_IN_OUT",
        }
    }
}

/// A use: its name, the statements, and the conditions after the call. `@` means `LAR1 P##p` of the block.
type Use = (&'static str, &'static str, &'static str);

struct Kind {
    name: &'static str,
    /// Actual parameters.
    actuals: &'static [&'static str],
    uses: &'static [Use],
}

/// Reads the word that the POINTER at AR1 leads to.
const READ_POINTER: &str = "@ L W [AR1,P#0.0]; T #n; L D [AR1,P#2.0]; LAR1; OPN DB [#n]; L W [AR1,P#0.0]; T MW 10;";
/// The same for an ANY.
const READ_ANY: &str = "@ L W [AR1,P#4.0]; T #n; L D [AR1,P#6.0]; LAR1; OPN DB [#n]; L W [AR1,P#0.0]; T MW 10;";
const WRITE_ANY: &str =
    "@ L W [AR1,P#4.0]; T #n; L D [AR1,P#6.0]; LAR1; OPN DB [#n]; L W#16#55AA; T W [AR1,P#0.0]; L W#16#1234; T MW 10;";
const HELD: &str = "//@ assert MW 10 == W#16#1234";

const TYPES: &[Kind] = &[
    Kind {
        name: "TIMER",
        actuals: &["T 5", "\"Tim\""],
        uses: &[
            ("start", "SET; L S5T#10s; SP #p; A #p; = M 1.0;", "//@ assert T 5 == 1 AND M 1.0 == 1"),
            ("reset", "SET; L S5T#10s; SE #p; R #p; O #p; = M 1.0;", "//@ assert T 5 == 0 AND M 1.0 == 0"),
            ("load", "SET; L S5T#10s; SP #p; LC #p; T MW 10; FR #p;", "//@ assert MW 10 == S5T#10s"),
            (
                "instance",
                "SET; L S5T#1s; SD #p; AN #p; = M 1.0; L #p; T MW 12;",
                "//@ assert MW 12 == 100 AND M 1.0 == 1",
            ),
        ],
    },
    Kind {
        name: "COUNTER",
        actuals: &["C 6"],
        uses: &[
            (
                "set",
                "SET; L C#7; S #p; CU #p; L #p; T MW 10; A #p; = M 1.0;",
                "//@ assert MW 10 == 8 AND C 6 == 1 AND M 1.0 == 1",
            ),
            ("reset", "SET; L C#7; S #p; R #p; LC #p; T MW 10;", "//@ assert MW 10 == 0 AND C 6 == 0"),
            ("down", "SET; L C#7; S #p; CD #p; LC #p; T MW 10;", "//@ assert MW 10 == 6"),
        ],
    },
    Kind {
        name: "BLOCK_FC",
        actuals: &["FC 3"],
        uses: &[
            ("call", "UC #p;", "//@ assert MW 20 == 1"),
            ("conditional", "SET; CC #p; CLR; CC #p;", "//@ assert MW 20 == 1"),
        ],
    },
    Kind {
        name: "BLOCK_FB",
        actuals: &["FB 4"],
        uses: &[
            ("call", "UC #p;", "//@ assert MW 20 == 10"),
            ("conditional", "SET; CC #p; CLR; CC #p;", "//@ assert MW 20 == 10"),
        ],
    },
    Kind {
        name: "BLOCK_DB",
        actuals: &["DB 10", "\"Data\""],
        uses: &[(
            "open",
            "OPN #p; L DBW 0; T MW 10; L DBNO; T MW 12;",
            "//@ assert MW 10 == W#16#1234 AND MW 12 == 10",
        )],
    },
    Kind { name: "BLOCK_SDB", actuals: &["SDB 1"], uses: &[("nothing", "NOP 0;", "")] },
    Kind {
        name: "POINTER",
        actuals: &[
            "P#DB10.DBX 0.0",
            "P#M 50.0",
            "DB10.w",
            "MW 50",
            "M 50.0",
            "#w",
            "\"Data\".w",
            "DB10.DBW 0",
            "DB10.s",
        ],
        uses: &[("value", READ_POINTER, HELD), ("handed to a function", "CALL FC 8 (p := #p, r := #n);", HELD)],
    },
    Kind {
        name: "ANY",
        actuals: &[
            "P#DB10.DBX 0.0 WORD 1",
            "P#M 50.0 BYTE 2",
            "DB10.w",
            "MW 50",
            "#w",
            "\"Data\".w",
            "DB10.DBW 0",
            "DB10.s",
            "DB10.a",
            "#s",
            "#y",
        ],
        uses: &[
            ("value", READ_ANY, HELD),
            ("written", WRITE_ANY, ""),
            ("copied", "CALL SFC 20 (SRCBLK := #p, RET_VAL := #n, DSTBLK := P#M 10.0 BYTE 2);", HELD),
            (
                "copied to",
                "CALL SFC 20 (SRCBLK := P#DB10.DBX 0.0 BYTE 2, RET_VAL := #n, DSTBLK := #p); CALL SFC 20 (SRCBLK := #p, RET_VAL := #n, DSTBLK := P#M 10.0 BYTE 2);",
                HELD,
            ),
            (
                "taken",
                "@ L D [AR1,P#0.0]; LAR2 P##y; T D [AR2,P#0.0]; L D [AR1,P#4.0]; T D [AR2,P#4.0]; L W [AR1,P#8.0]; T W [AR2,P#8.0]; CALL SFC 20 (SRCBLK := #y, RET_VAL := #n, DSTBLK := P#M 10.0 BYTE 2);",
                HELD,
            ),
        ],
    },
];

#[derive(Clone)]
struct Plan {
    chain: Vec<Link>,
    kind: &'static Kind,
    using: &'static Use,
    actual: &'static str,
}

impl Plan {
    fn exists(&self) -> bool {
        let pointer = matches!(self.kind.name, "POINTER" | "ANY");
        self.chain.windows(2).all(|pair| !(pair[1].is_own() && pair[0].is_function()))
            && !self.chain[0].is_own()
            // Numbers are inputs.
            && (pointer || self.chain.iter().all(|link| matches!(link, FcIn | FbIn | OwnIn)))
    }

    fn source(&self) -> String {
        let ty = self.kind.name;
        let mut out = String::from(
            "DATA_BLOCK DB 10\nSTRUCT w : WORD := W#16#1234; s : STRUCT a : WORD := W#16#1234; b : REAL; END_STRUCT; a : ARRAY [1..3] OF WORD := 3 (W#16#1234); END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n\
             FUNCTION FC 3 : VOID\nBEGIN\nL MW 20; + 1; T MW 20;\nEND_FUNCTION\n\
             FUNCTION_BLOCK FB 4\nBEGIN\nL MW 20; + 10; T MW 20;\nEND_FUNCTION_BLOCK\n",
        );
        _ = writeln!(
            out,
            "FUNCTION FC 8 : VOID\nVAR_INPUT p : POINTER; END_VAR\nVAR_OUTPUT r : INT; END_VAR\nVAR_TEMP n : WORD; END_VAR\nBEGIN\n{} T #r;\nEND_FUNCTION",
            READ_POINTER.replace('@', "LAR1 P##p;")
        );
        // From the last one to the first, so that types of multi-instances are known.
        for (at, link) in self.chain.iter().enumerate().rev() {
            let base = if link.is_function() { "LAR1 P##p;" } else { "LAR1 P##p; TAR2; +AR1;" };
            let next = self.chain.get(at + 1);
            let body = match next {
                None => {
                    let body = self.using.1.replace('@', base);
                    if body.contains("AR2") { format!("TAR2 MD 40; {body} LAR2 MD 40;") } else { body }
                }
                Some(next) => Plan::call(*next, at + 1, "#p"),
            };
            let own = match next {
                Some(next) if next.is_own() => format!("VAR pad : ARRAY [1..3] OF INT; m : FB {}; END_VAR\n", 31 + at),
                _ => String::new(),
            };
            let declared = format!(
                "{} p : {ty}; END_VAR\n{own}VAR_TEMP n : INT; y : ANY; END_VAR\nBEGIN\n{body}\n",
                link.section()
            );
            if link.is_function() {
                _ = writeln!(out, "FUNCTION FC {} : VOID\n{declared}END_FUNCTION", 30 + at);
            } else {
                _ = writeln!(out, "FUNCTION_BLOCK FB {}\n{declared}END_FUNCTION_BLOCK", 30 + at);
                if !link.is_own() {
                    _ = writeln!(out, "DATA_BLOCK DB {0}\nFB {0}\nBEGIN\nEND_DATA_BLOCK", 30 + at);
                }
            }
        }
        let actual = self.actual.replace("\"Tim\"", "T 5").replace("\"Data\"", "DB 10").replace("DB 10.", "DB10.");
        let before = match self.actual {
            "#w" => "L W#16#1234; T #w;",
            "#s" => "L W#16#1234; T #s.a;",
            "#y" => {
                "LAR1 P##y; L DW#16#10040001; T D [AR1,P#0.0]; L 10; T W [AR1,P#4.0]; L P#DBX 0.0; T D [AR1,P#6.0];"
            }
            _ => "",
        };
        let after = match (self.using.0, self.actual) {
            ("written", "#w") => "//@ assert #w == W#16#55AA",
            ("written", "#s") => "//@ assert #s.a == W#16#55AA",
            ("written", "MW 50" | "P#M 50.0 BYTE 2") => "//@ assert MW 50 == W#16#55AA",
            ("written", "DB10.s") => "//@ assert DB10.s.a == W#16#55AA",
            ("written", "DB10.a") => "//@ assert DB10.a[1] == W#16#55AA",
            ("written", _) => "//@ assert DB10.w == W#16#55AA",
            _ => self.using.2,
        };
        _ = writeln!(
            out,
            "ORGANIZATION_BLOCK OB 1\nVAR_TEMP info : ARRAY [1..20] OF BYTE; w : WORD; s : STRUCT a : WORD; b : REAL; END_STRUCT; y : ANY; END_VAR\nBEGIN\nL W#16#1234; T MW 50;\n{before}\n{}\n{after}\nNOP 0;\n//@ assert MW 50 == MW 50\nEND_ORGANIZATION_BLOCK",
            Plan::call(self.chain[0], 0, &actual)
        );
        out
    }

    fn call(link: Link, at: usize, actual: &str) -> String {
        match link {
            FcIn | FcOut | FcInOut => format!("CALL FC {} (p := {actual});", 30 + at),
            FbIn | FbInOut => format!("CALL FB {0}, DB {0} (p := {actual});", 30 + at),
            OwnIn | OwnInOut => format!("CALL #m (p := {actual});"),
        }
    }
}

fn cases(cpu: &'static str) -> Vec<Case> {
    let mut chains: Vec<Vec<Link>> = Vec::new();
    for first in LINKS {
        chains.push(vec![first]);
        for second in LINKS {
            chains.push(vec![first, second]);
            chains.extend(LINKS.map(|third| vec![first, second, third]));
        }
    }
    let mut cases = Vec::new();
    for kind in TYPES {
        for using in kind.uses {
            for actual in kind.actuals {
                for chain in &chains {
                    let plan = Plan { chain: chain.clone(), kind, using, actual };
                    if plan.exists() {
                        cases.push(Case {
                            kind: format!("{chain:?}"),
                            ty: kind.name,
                            using: using.0,
                            variant: format!("{cpu}, {actual}"),
                            ending: "stl",
                            cpu,
                            source: Box::new(move || plan.source()),
                        });
                    }
                }
            }
        }
    }
    cases
}

/// No operand names a system data block, and no instruction uses one.
const REFUSALS: &[Refusal] = &[Refusal { kinds: &["*"], types: &["BLOCK_SDB"], uses: &["*"], code: "P0201" }];

#[test]
fn parameters_are_handed_on() {
    campaign(cases("s7-300"), 19, REFUSALS);
}
