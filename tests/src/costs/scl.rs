//! Sequences of SCL: statements, operators, and each function of the language.

use super::Row;

/// Name and sequence. `D` has the values that change; the names of its variables begin with their type.
#[rustfmt::skip]
const SEQUENCES: &[(&str, &str)] = &[
    (":=", "D.io := D.i1"),
    ("IF", "IF D.b1 THEN D.io := D.i1; ELSE D.io := D.i2; END_IF"),
    ("CASE", "CASE D.k OF 0: D.io := 5; 1: D.io := D.i1; 2: D.io := D.i2; ELSE D.io := 0; END_CASE"),
    ("FOR", "FOR #i := 0 TO 9 DO D.a[#i] := #i; END_FOR"),
    ("WHILE", "#i := 0; WHILE #i < 10 DO #i := #i + 1; D.a[0] := #i; END_WHILE"),
    ("REPEAT", "#i := 0; REPEAT #i := #i + 1; D.a[0] := #i; UNTIL #i >= 10 END_REPEAT"),
    ("CONTINUE", "FOR #i := 0 TO 9 DO IF D.b1 THEN CONTINUE; END_IF; D.a[#i] := #i; END_FOR"),
    ("EXIT", "FOR #i := 0 TO 9 DO IF #i > D.k THEN EXIT; END_IF; D.a[#i] := #i; END_FOR"),
    ("RETURN", "IF D.b1 THEN RETURN; END_IF; D.io := D.i1"),
    ("array element", "D.io := D.a[D.k]"),
    ("text :=", "D.so := D.s1"),
    ("+", "D.io := D.i1 + D.i2"),
    ("+ DINT", "D.do := D.d1 + D.d2"),
    ("+ REAL", "D.ro := D.r1 + D.r2"),
    ("+ LREAL", "D.lo := D.l1 + D.l1"),
    ("-", "D.io := D.i1 - D.i2"),
    ("*", "D.io := D.i1 * D.i2"),
    ("/", "D.io := D.i1 / D.i2"),
    ("/ REAL", "D.ro := D.r1 / D.r2"),
    ("MOD", "D.io := D.i1 MOD D.i2"),
    ("**", "D.ro := D.r1 ** D.u1"),
    ("AND", "D.bo := D.b1 AND D.b2"),
    ("OR", "D.bo := D.b1 OR D.b2"),
    ("XOR", "D.bo := D.b1 XOR D.b2"),
    ("NOT", "D.bo := NOT D.b1"),
    ("=", "D.bo := D.i1 = D.i2"),
    ("<>", "D.bo := D.i1 <> D.i2"),
    ("<", "D.bo := D.i1 < D.i2"),
    ("<=", "D.bo := D.i1 <= D.i2"),
    (">", "D.bo := D.i1 > D.i2"),
    (">=", "D.bo := D.i1 >= D.i2"),
    ("> REAL", "D.bo := D.r1 > D.r2"),
    ("= STRING", "D.bo := D.s1 = D.s2"),
    ("INT_TO_REAL", "D.ro := INT_TO_REAL(D.i1)"),
    ("REAL_TO_INT", "D.io := REAL_TO_INT(D.r1)"),
    ("DINT_TO_INT", "D.io := DINT_TO_INT(D.d1)"),
    ("ABS", "D.io := ABS(D.i1)"),
    ("SQR", "D.ro := SQR(D.r1)"),
    ("SQRT", "D.ro := SQRT(D.r1)"),
    ("EXP", "D.ro := EXP(D.u1)"),
    ("EXPD", "D.ro := EXPD(D.u1)"),
    ("LN", "D.ro := LN(D.r1)"),
    ("LOG", "D.ro := LOG(D.r1)"),
    ("SIN", "D.ro := SIN(D.u1)"),
    ("COS", "D.ro := COS(D.u1)"),
    ("TAN", "D.ro := TAN(D.u1)"),
    ("ASIN", "D.ro := ASIN(D.u1)"),
    ("ACOS", "D.ro := ACOS(D.u1)"),
    ("ATAN", "D.ro := ATAN(D.u1)"),
    ("FRAC", "D.ro := FRAC(D.r1)"),
    ("ROUND", "D.do := ROUND(D.r1)"),
    ("TRUNC", "D.do := TRUNC(D.r1)"),
    ("CEIL", "D.do := CEIL(D.r1)"),
    ("FLOOR", "D.do := FLOOR(D.r1)"),
    ("MIN", "D.io := MIN(IN1 := D.i1, IN2 := D.i2)"),
    ("MAX", "D.io := MAX(IN1 := D.i1, IN2 := D.i2)"),
    ("LIMIT", "D.io := LIMIT(MN := -100, IN := D.i1, MX := 100)"),
    ("SEL", "D.io := SEL(G := D.b1, IN0 := D.i1, IN1 := D.i2)"),
    ("MUX", "D.io := MUX(K := D.k, IN0 := D.i1, IN1 := D.i2, INELSE := 7)"),
    ("DEMUX", "DEMUX(K := D.k, IN := D.i1, OUT0 => D.io, OUT1 => D.i3, OUTELSE => D.i4)"),
    ("NORM_X", "D.ro := NORM_X(MIN := -100, VALUE := D.i1, MAX := 100)"),
    ("SCALE_X", "D.io := SCALE_X(MIN := -100, VALUE := D.u1, MAX := 100)"),
    ("SHL", "D.wo := SHL(IN := D.w1, N := 3)"),
    ("SHR", "D.wo := SHR(IN := D.w1, N := 3)"),
    ("ROL", "D.wo := ROL(IN := D.w1, N := 3)"),
    ("ROR", "D.wo := ROR(IN := D.w1, N := 3)"),
    ("SWAP", "D.wo := SWAP(D.w1)"),
    ("ENCO", "D.io := ENCO(D.w1)"),
    ("DECO", "D.wo := DECO(D.k)"),
    ("BITSUM", "D.io := BITSUM(D.x1)"),
    ("IS_VALID", "D.bo := IS_VALID(D.r1)"),
    ("LOWER_BOUND", "D.do := LOWER_BOUND(ARR := #v, DIM := 1)"),
    ("UPPER_BOUND", "D.do := UPPER_BOUND(ARR := #v, DIM := 1)"),
    ("CountOfElements", "D.do := UDINT_TO_DINT(CountOfElements(#w))"),
    ("TypeOf", "D.bo := TypeOf(#w) = Int"),
    ("TypeOfElements", "D.bo := TypeOfElements(#w) = Int"),
    ("IS_ARRAY", "D.bo := IS_ARRAY(#w)"),
    ("RESET_TIMER", "RESET_TIMER(D.t)"),
    ("PRESET_TIMER", "PRESET_TIMER(PT := T#2s, TIMER := D.t)"),
    ("S_PULSE", "D.so5 := S_PULSE(T_NO := %T{n}, S := D.b1, TV := S5T#100ms, R := FALSE, Q => D.bo, BI => D.wo)"),
    ("S_PEXT", "D.so5 := S_PEXT(T_NO := %T{n}, S := D.b1, TV := S5T#100ms, R := FALSE, Q => D.bo, BI => D.wo)"),
    ("S_ODT", "D.so5 := S_ODT(T_NO := %T{n}, S := D.b1, TV := S5T#100ms, R := FALSE, Q => D.bo, BI => D.wo)"),
    ("S_ODTS", "D.so5 := S_ODTS(T_NO := %T{n}, S := D.b1, TV := S5T#100ms, R := FALSE, Q => D.bo, BI => D.wo)"),
    ("S_OFFDT", "D.so5 := S_OFFDT(T_NO := %T{n}, S := D.b1, TV := S5T#100ms, R := FALSE, Q => D.bo, BI => D.wo)"),
    ("S_CU", "D.wo := S_CU(C_NO := %C{n}, CU := D.b1, S := FALSE, PV := 16#5, R := FALSE, Q => D.bo)"),
    ("S_CD", "D.wo := S_CD(C_NO := %C{n}, CD := D.b1, S := FALSE, PV := 16#5, R := FALSE, Q => D.bo)"),
    ("S_CUD", "D.wo := S_CUD(C_NO := %C{n}, CU := D.b1, CD := D.b2, S := FALSE, PV := 16#5, R := FALSE, Q => D.bo)"),
    ("PEEK_BOOL", "D.bo := PEEK_BOOL(AREA := 16#83, DBNUMBER := 0, BYTEOFFSET := D.k, BITOFFSET := 3)"),
    ("PEEK", "#y := PEEK(AREA := 16#83, DBNUMBER := 0, BYTEOFFSET := D.k); D.yo := #y"),
    ("POKE_BOOL", "POKE_BOOL(AREA := 16#83, DBNUMBER := 0, BYTEOFFSET := {p}, BITOFFSET := 3, VALUE := D.b1)"),
    ("POKE_BLK", "POKE_BLK(AREA_SRC := 16#83, DBNUMBER_SRC := 0, BYTEOFFSET_SRC := 10, AREA_DEST := 16#83, DBNUMBER_DEST := 0, BYTEOFFSET_DEST := {p}, COUNT := 8)"),
    ("POKE", "POKE(AREA := 16#83, DBNUMBER := 0, BYTEOFFSET := {p} + D.k, VALUE := D.w1)"),
    ("MOVE_BLK", "MOVE_BLK(IN := D.a[0], COUNT := 5, OUT => D.z[0])"),
    ("UMOVE_BLK", "UMOVE_BLK(IN := D.a[0], COUNT := 5, OUT => D.z[0])"),
    ("FILL_BLK", "FILL_BLK(IN := D.i1, COUNT := 5, OUT => D.z[0])"),
    ("UFILL_BLK", "UFILL_BLK(IN := D.i1, COUNT := 5, OUT => D.z[0])"),
    ("SCATTER", "SCATTER(IN := D.w1, OUT => D.f)"),
    ("GATHER", "GATHER(IN := D.f, OUT => D.wo)"),
    ("SCATTER_BLK", "SCATTER_BLK(IN := D.ws[0], COUNT_IN := 2, OUT => D.ff[0])"),
    ("GATHER_BLK", "GATHER_BLK(IN := D.ff[0], COUNT_OUT := 2, OUT => D.ws[0])"),
    ("S_MOVE", "S_MOVE(IN := D.s1, OUT => D.so)"),
    ("CONCAT", "D.so := CONCAT(IN1 := D.s1, IN2 := D.s2)"),
    ("CONCAT_STRING", "D.so := CONCAT_STRING(IN1 := D.s1, IN2 := D.s2)"),
    ("CONCAT_WSTRING", "D.wso := CONCAT_WSTRING(IN1 := D.ws1, IN2 := D.ws1)"),
    ("S_CONV", "S_CONV(IN := D.i1, OUT => D.so)"),
    ("STRG_VAL", "STRG_VAL(IN := D.s1, FORMAT := 16#0000, P := #p, OUT => D.io)"),
    ("VAL_STRG", "#p := 1; VAL_STRG(IN := D.i1, SIZE := 10, PREC := 0, FORMAT := 16#0000, P := #p, OUT => D.so)"),
    ("T_ADD", "D.tio := T_ADD(IN1 := D.ti1, IN2 := T#1s)"),
    ("T_SUB", "D.tio := T_SUB(IN1 := D.ti1, IN2 := T#1s)"),
    ("T_DIFF", "D.tio := T_DIFF(IN1 := D.dt1, IN2 := D.dt2)"),
    ("T_CONV", "D.do := T_CONV(D.ti1)"),
];

/// All sequences.
pub fn rows() -> Vec<Row> {
    SEQUENCES.iter().map(|(name, sequence)| Row::new("SCL", name, sequence)).collect()
}

/// What OB 1 does in each scan to fill `D`.
pub const FILL: &str = "      L     MW 0
      T     \"D\".i1
      L     MW 4
      T     \"D\".i2
      L     MD 8
      T     \"D\".d1
      T     \"D\".ti1
      T     \"D\".x1
      L     MD 12
      T     \"D\".d2
      L     MD 200
      T     \"D\".r1
      L     MD 204
      T     \"D\".r2
      L     MD 208
      T     \"D\".u1
      L     MW 16
      T     \"D\".w1
      L     MB 218
      ITD
      T     \"D\".k
      A     M 20.0
      =     \"D\".b1
      A     M 20.1
      =     \"D\".b2
";

/// The data that sequences of SCL, LAD and FBD share.
pub const DATA: &str = "DATA_BLOCK \"D\"
{ S7_Optimized_Access := 'FALSE' }
VAR
  i1 : INT; i2 : INT; i3 : INT; i4 : INT; io : INT;
  d1 : DINT; d2 : DINT; do : DINT; k : INT;
  r1 : REAL; r2 : REAL; u1 : REAL; ro : REAL; l1 : LREAL; lo : LREAL;
  w1 : WORD; wo : WORD; x1 : DWORD; yo : BYTE;
  b1 : BOOL; b2 : BOOL; bo : BOOL;
  a : ARRAY[0..15] OF INT; z : ARRAY[0..15] OF INT; f : ARRAY[0..15] OF BOOL; ff : ARRAY[0..31] OF BOOL; ws : ARRAY[0..3] OF WORD;
  s1 : STRING[20] := '123'; s2 : STRING[20] := 'abc'; so : STRING[60];
  ws1 : WSTRING[20] := WSTRING#'abc'; wso : WSTRING[60];
  so5 : S5TIME; ti1 : TIME; tio : TIME;
  dt1 : DTL := DTL#2024-02-29-12:00:00; dt2 : DTL := DTL#2024-02-28-11:00:00;
  e0 : BOOL; t : TON_TIME;
END_VAR
BEGIN
END_DATA_BLOCK
";

/// A CPU that runs the sequences, and the sources with their functions.
pub fn sources(blocks: Vec<(usize, String)>, main: String) -> (&'static str, Vec<(&'static str, String)>) {
    let mut text = DATA.to_string();
    // After the functions of rows, whose numbers follow their order.
    let mut inner = String::new();
    for (number, sequence) in [(1, String::new())].into_iter().chain(blocks) {
        let sequence = sequence.replace("D.", "\"D\".");
        // Questions about a variant or an array of any bounds need a parameter that is one.
        let parameter =
            [("v", "ARRAY[*] OF INT"), ("w", "VARIANT")].into_iter().find(|(name, _)| uses(&sequence, name));
        if let Some((name, ty)) = parameter {
            text.push_str(&function(&format!("R{number}"), "", &format!("\"I{number}\"({name} := \"D\".a)")));
            inner.push_str(&function(
                &format!("I{number}"),
                &format!("VAR_IN_OUT\n  {name} : {ty};\nEND_VAR\n"),
                &sequence,
            ));
            continue;
        }
        let locals = [("i", "INT"), ("p", "UINT"), ("y", "BYTE")].into_iter().filter(|(name, _)| uses(&sequence, name));
        let temps: String = locals.map(|(name, ty)| format!("VAR_TEMP\n  {name} : {ty};\nEND_VAR\n")).collect();
        text.push_str(&function(&format!("R{number}"), &temps, &sequence));
    }
    ("s7-1500", vec![("costs.scl", text + &inner), ("main.stl", main)])
}

fn uses(sequence: &str, name: &str) -> bool {
    sequence.split(|c: char| !c.is_alphanumeric() && c != '#').any(|word| word.strip_prefix('#') == Some(name))
}

fn function(name: &str, declarations: &str, statements: &str) -> String {
    let statements = if statements.is_empty() { String::new() } else { format!("  {statements};\n") };
    format!("FUNCTION \"{name}\" : VOID\n{declarations}BEGIN\n{statements}END_FUNCTION\n")
}
