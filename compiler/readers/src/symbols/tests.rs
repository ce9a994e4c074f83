//! Tables in each of the formats, and texts that are not tables.

use plcc_syntax::ast::{Area, BlockPrefix, CellKind, Width};

use super::*;

fn read(text: &str) -> (Vec<(String, SymbolTarget, String)>, usize) {
    assert!(is_symbol_table(text), "not taken for a table: {text:?}");
    let (table, diagnostics) = parse(FileId(0), &SourceFile::new("table", text));
    assert!(diagnostics.iter().all(|diagnostic| diagnostic.code == Code::SymbolTable));
    let rows = table.symbols.into_iter().map(|symbol| (symbol.name, symbol.target, symbol.ty)).collect();
    (rows, diagnostics.len())
}

const LAMP: SymbolTarget = SymbolTarget::Memory { area: Area::Q, width: Width::Bit, byte: 4, bit: 1 };
const SCALE: SymbolTarget = SymbolTarget::Block { prefix: BlockPrefix::Fc, number: 105 };

#[test]
fn fixed_columns() {
    let text = format!(
        "126,{:<24}{:<12}{:<10}{:<80}\r\n126,{:<24}{:<12}{:<10}\n126,nonsense\n",
        "Lamp on", "A       4.1", "BOOL", "text", "SCALE", "FC    105", "FC    105"
    );
    let (rows, bad) = read(&text);
    assert_eq!(rows[0], ("Lamp on".to_string(), LAMP, "BOOL".to_string()));
    assert_eq!(rows[1].1, SCALE);
    assert_eq!((rows.len(), bad), (2, 1));
}

#[test]
fn quoted_fields() {
    let text = "\"Lamp on   \",\"Q      4.1 \",\"BOOL      \",\"a \"\"text\"\", and more\"\n\"x\",\"broken\n\"SCALE\",\"FC 105\",\"FC 105\",\"\"\n";
    let (rows, bad) = read(text);
    assert_eq!(rows[0].1, LAMP);
    assert_eq!(rows[1].1, SCALE);
    assert_eq!((rows.len(), bad), (2, 1));
}

#[test]
fn portal_columns() {
    let (rows, bad) = read("\"Lamp\",\"%Q4.1\",\"Bool\",\"True\",\"True\",\"False\",\"text\",\"\",\"True\"\n");
    assert_eq!((rows[0].1, bad), (LAMP, 0));
}

#[test]
fn portal_columns_say_what_clients_may_not_access() {
    let text = "\"A\",\"%MW0\",\"Int\",\"False\",\"False\",\"False\",\"text\",\"\",\"False\"\n\"B\",\"%MW2\",\"Int\",\"True\",\"False\",\"False\",\"\",\"\",\"True\"\n\
                \"Bad\",\"%X9\",\"Int\",\"False\",\"False\",\"False\",\"\"\n\"C\",\"%MW4\",\"Int\",\"True\",\"True\",\"False\",\"\"\n\"D\",\"MW 6\",\"INT\",\"False\"\n";
    let (table, _) = parse(FileId(0), &SourceFile::new("table", text));
    let hidden: Vec<(&str, bool)> =
        table.symbols.iter().map(|symbol| (symbol.name.as_str(), symbol.external == External::Hidden)).collect();
    assert_eq!(hidden, [("A", true), ("B", false), ("C", false), ("D", false)]);
}

#[test]
fn columns_say_what_clients_may_do() {
    let text = "Name;Data Type;Logical Address;Hmi Visible;Hmi Accessible;Hmi Writeable\nA;Int;%MW0;False;False;False\nBad;Int;%X9;;False;\n\
                B;Int;%MW2;True;True;False\nC;Int;%MW4;False;True;True\nD;Int;%MW6\n";
    let (table, _) = parse(FileId(0), &SourceFile::new("table", text));
    let found: Vec<(&str, External)> =
        table.symbols.iter().map(|symbol| (symbol.name.as_str(), symbol.external)).collect();
    assert_eq!(found, [("A", External::Hidden), ("B", External::Read), ("C", External::Write), ("D", External::Write)]);
}

#[test]
fn assignment_list() {
    let (rows, bad) = read("\tA 4.1\tLamp on\ttext\r\n\tFC 105\tSCALE\t\r\n\tFC\r\n");
    assert_eq!((rows[0].1, rows[1].1, bad), (LAMP, SCALE, 1));
}

#[test]
fn interchange_format() {
    let text = "TABLE\n0,1\n\"t\"\nVECTORS\n0,2\n\"\"\nTUPLES\n0,4\n\"\"\nDATA\n0,0\n\"\"\n-1,0\nBOT\n1,0\n\"Lamp\"\n1,0\n\"Q 4.1\"\n1,0\n\"BOOL\"\n1,0\n\"\"\n-1,0\nBOT\n1,0\n\"SCALE\"\n1,0\n\"FC  105\"\n1,0\n\"FC  105\"\n1,0\n\"\"\n-1,0\nEOD\n";
    let (rows, bad) = read(text);
    assert_eq!((rows.len(), rows[0].1, rows[1].1, bad), (2, LAMP, SCALE, 0));
}

#[test]
fn semicolons_with_and_without_header() {
    let (rows, bad) = read("Lamp;A 4.1;BOOL;text\nSCALE;FC105;FC 105;\n");
    assert_eq!((rows[0].1, rows[1].1, bad), (LAMP, SCALE, 0));
    let (rows, bad) = read("Symbol;Address;Type;Comment\nLamp;Q4.1;BOOL;\nx;y;z\n");
    assert_eq!((rows[0].1, rows.len(), bad), (LAMP, 1, 1));
}

fn rows_of_s7200(text: &str) -> Vec<(String, String, String)> {
    assert!(is_symbol_table(text), "not taken for a table: {text:?}");
    let (table, diagnostics) = parse(FileId(0), &SourceFile::new("table", text));
    assert_eq!(diagnostics, []);
    for row in &table.s7200 {
        assert!(
            text[row.name_span.range()].contains(&row.name) && text[row.address_span.range()].contains(&row.address)
        );
    }
    table.s7200.into_iter().map(|row| (row.name, row.address, row.comment)).collect()
}

#[test]
fn tables_for_the_s7_200() {
    let row = |name: &str, address: &str, comment: &str| (name.to_string(), address.to_string(), comment.to_string());
    assert_eq!(
        rows_of_s7200(
            "Motor\tQ0.0\tthe pump, large\r\nLevel\tVW100\t\r\nFirst\tSM0.1\r\nMixer\tSBR3\tblock\r\nMax\t16#FF\r\n"
        ),
        [
            row("Motor", "Q0.0", "the pump, large"),
            row("Level", "VW100", ""),
            row("First", "SM0.1", ""),
            row("Mixer", "SBR3", "block"),
            row("Max", "16#FF", "")
        ]
    );
    assert_eq!(
        rows_of_s7200("Symbol,Address,Comment\n水泵,Q0.0,\nTime,T37,5 s\n"),
        [row("水泵", "Q0.0", ""), row("Time", "T37", "5 s")]
    );
    assert_eq!(
        rows_of_s7200("Level;VW100;text\nStop;I0.1;\n"),
        [row("Level", "VW100", "text"), row("Stop", "I0.1", "")]
    );
    let german = "\"Symbol\",\"Adresse\",\"Kommentar\"\n\"Motor\",\"A0.0\",\"Pumpe\"\n\"Level\",\"VW100\",\"\"\n";
    assert_eq!(rows_of_s7200(german), [row("Motor", "A0.0", ""), row("Level", "VW100", "")]);
    for head in ["\t\tSymbol\tAddress\tComment\n", ""] {
        assert_eq!(
            rows_of_s7200(&format!("{head}\t\tMotor\tQ0.0\tpump\n\t\tLevel\tVW100\t\n")),
            [row("Motor", "Q0.0", "pump"), row("Level", "VW100", "")]
        );
    }
    // String constants are in double quotes, but so may be all cells.
    let constants =
        "Symbol\tAddress\tComment\nGreeting\t\"Hello, all\"\ttext\nLetter\t'A'\t\nLevel\tVW100\t\nLamp\tQ0.0\t\n";
    assert_eq!(rows_of_s7200(constants)[..2], [row("Greeting", "\"Hello, all\"", "text"), row("Letter", "'A'", "")]);
    assert_eq!(s7200::separator("\"Motor\"\t\"VW0\"\t\"\"\n\"Level\"\t\"VW2\"\t\"\"\n"), None);
    // Both families can read these.
    let (table, _) = parse(FileId(0), &SourceFile::new("table", "Key\tI0.0\t\nLamp\tM1.5\t\n"));
    assert_eq!((table.symbols.len(), table.s7200.len()), (2, 2));
    let (table, _) = parse(FileId(0), &SourceFile::new("table", "\tE 0.0\tKey\t\n"));
    assert_eq!((table.s7200[0].address.as_str(), table.symbols.len()), ("E0.0", 1));
    // A table for S7-300 with a bad row.
    let (_, bad) = read("Lamp;A 4.1;BOOL;text\nSCALE;FC105;FC 105;\nx;VW 100;WORD;\n");
    assert_eq!(bad, 1);
}

#[test]
fn programs_are_no_tables() {
    for text in [
        "A I 0.0; = Q 4.0;\n",
        "\tA I 0.0\n\t= Q 4.0\n",
        "FUNCTION FC 1 : VOID\n",
        "",
        "L 1; T MW 2; BE\n",
        "LD\tI0.0\nA\tI0.1\n",
        "\tLD\tI0.0\n\tA\tI0.1\n",
        "\tU\tE0.0\n\tSPB\tM001\n\tTAR1\tMD20\n",
        "VW0 1\nSpeed\t5, 6\n",
        "Speed, 5\n",
        "TON\tT37, 50\nMOVW\tVW0, VW2\n",
    ] {
        assert!(!is_symbol_table(text), "{text:?}");
    }
}

#[test]
fn addresses() {
    assert_eq!(
        parse_address("MW  10"),
        Some(SymbolTarget::Memory { area: Area::M, width: Width::Word, byte: 10, bit: 0 })
    );
    assert_eq!(parse_address("Z 5"), Some(SymbolTarget::Cell { kind: CellKind::Counter, number: 5 }));
    for bad in ["M 10", "MW 10.1", "M 10.8", "DBX 1.0", "FC", "10", "", "MW 99999999"] {
        assert_eq!(parse_address(bad), None, "{bad}");
    }
}
