//! Plants in STL of any size, for measuring the compiler: areas with motors, valves and an analog value each, written as plant
//! programs are. Function blocks are shared, instances and area logic are not.

use std::fmt::Write as _;

/// Blocks that all areas use.
const SHARED: &str = include_str!("plants/shared.stl");

/// Motors and valves of an area.
const DEVICES: usize = 5;

/// A plant of about `lines` lines. `setpoint` is a number in the code of one area, and a start value of its DB: another one
/// makes a program with one changed block of code.
pub fn plant(lines: usize, setpoint: u16) -> String {
    let mut text = String::with_capacity(lines * 24);
    text.push_str(SHARED);
    let per_area = area(0, 0).lines().count() + 1;
    let count = lines.saturating_sub(SHARED.lines().count()).div_ceil(per_area).max(1);
    for number in 0..count {
        let setpoint = if number == count / 2 { setpoint } else { 1000 };
        text.push_str(&area(number, setpoint));
    }
    text.push_str("ORGANIZATION_BLOCK OB 1\nVAR_TEMP\n  info : ARRAY [0..19] OF BYTE;\nEND_VAR\nBEGIN\nNETWORK\n");
    for number in 0..count {
        writeln!(text, "      CALL  FC {};", FIRST_AREA + number).expect("a string takes all");
    }
    text.push_str("END_ORGANIZATION_BLOCK\n");
    text
}

/// Number of the FC of the first area.
const FIRST_AREA: usize = 100;

/// The blocks of one area.
fn area(number: usize, setpoint: u16) -> String {
    let mut text = String::new();
    let mut line = |arguments: std::fmt::Arguments<'_>| {
        text.write_fmt(arguments).expect("a string takes all");
        text.push('\n');
    };
    let db = |device: usize| 100 + number * (2 * DEVICES + 2) + device;
    // Areas take turns with inputs, outputs, bit memory and timers.
    let (input, output, memory) = (number * 4 % 1024, number * 3 % 1024, 100 + number * 16 % 8000);
    for motor in 0..DEVICES {
        line(format_args!("DATA_BLOCK DB {}\n  FB 1\nBEGIN\nEND_DATA_BLOCK", db(motor)));
        line(format_args!("DATA_BLOCK DB {}\n  FB 2\nBEGIN\nEND_DATA_BLOCK", db(DEVICES + motor)));
    }
    line(format_args!("DATA_BLOCK DB {}\n  FB 3\nBEGIN\nEND_DATA_BLOCK", db(2 * DEVICES)));
    line(format_args!(
        "DATA_BLOCK DB {}\nSTRUCT\n  setpoint : INT := {setpoint};\n  starts : DINT;\n  level : REAL;\n  \
         alarms : WORD;\n  recipe : ARRAY [1..8] OF INT;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK",
        db(2 * DEVICES + 1)
    ));
    let data = db(2 * DEVICES + 1);
    line(format_args!("FUNCTION FC {} : VOID\nTITLE = Area {number}\nVAR_TEMP", FIRST_AREA + number));
    line(format_args!("  enabled : BOOL;\n  sum : INT;\n  work : REAL;\nEND_VAR\nBEGIN"));
    line(format_args!("NETWORK\nTITLE = Release of the area"));
    line(format_args!(
        "      A     I {input}.0;          // main switch\n      AN    I {input}.1;          // emergency stop"
    ));
    line(format_args!("      A(    ;\n      O     M {memory}.0;\n      O     M {memory}.1;\n      )     ;"));
    line(format_args!("      =     #enabled;\n      FP    M {memory}.2;\n      JCN   m001;"));
    line(format_args!("      L     DB{data}.DBD 2;\n      L     L#1;\n      +D    ;\n      T     DB{data}.DBD 2;"));
    line(format_args!("m001: NOP   0;"));
    for motor in 0..DEVICES {
        let (next, bit) = ((motor + 1) % DEVICES, motor % 8);
        line(format_args!("NETWORK\nTITLE = Motor {motor}"));
        line(format_args!("      A     #enabled;\n      A     I {}.{bit};", input + 1));
        line(format_args!(
            "      AN    M {}.{next};        // interlock\n      =     M {}.{bit};",
            memory + 4,
            memory + 6
        ));
        line(format_args!(
            "      A     M {}.{bit};\n      L     S5T#{}S;\n      SD    T {};",
            memory + 6,
            2 + motor,
            (number * 5 + motor) % 2000
        ));
        line(format_args!("      A     T {};\n      =     M {}.{bit};", (number * 5 + motor) % 2000, memory + 4));
        line(format_args!("      CALL  FB 1 , DB {} (", db(motor)));
        line(format_args!(
            "           command := M {}.{bit},\n           feedback := I {}.{bit},",
            memory + 6,
            input + 2
        ));
        line(format_args!(
            "           delay := {},\n           run := Q {output}.{bit},\n           fault := M {}.{bit});",
            10 + motor,
            memory + 8
        ));
        line(format_args!("NETWORK\nTITLE = Valve {motor}"));
        line(format_args!("      CALL  FB 2 , DB {} (", db(DEVICES + motor)));
        line(format_args!("           open := M {}.{bit},\n           opened := I {}.{bit},", memory + 4, input + 3));
        line(format_args!("           position := MW {},\n           valve := Q {}.{bit});", memory + 10, output + 1));
        line(format_args!(
            "      L     DB{data}.DBW {};\n      L     {};\n      >I    ;",
            12 + 2 * motor,
            100 * motor + number % 90
        ));
        line(format_args!(
            "      S     M {}.{bit};\n      A     I {}.{bit};\n      R     M {}.{bit};",
            memory + 12,
            input + 2,
            memory + 12
        ));
    }
    line(format_args!("NETWORK\nTITLE = Level"));
    line(format_args!("      CALL  FB 3 , DB {} (", db(2 * DEVICES)));
    line(format_args!(
        "           raw := MW {},\n           setpoint := DB{data}.DBW 0,\n           filtered := DB{data}.DBD 6);",
        memory + 10
    ));
    line(format_args!(
        "      L     DB{data}.DBD 6;\n      L     {}.5;\n      *R    ;\n      T     #work;",
        number % 50
    ));
    line(format_args!(
        "      L     #work;\n      L     1.000000e+003;\n      >R    ;\n      =     M {}.7;",
        memory + 8
    ));
    line(format_args!("NETWORK\nTITLE = Alarms"));
    line(format_args!("      L     0;\n      T     #sum;"));
    for index in 0..4 {
        line(format_args!(
            "      L     #sum;\n      L     DB{data}.DBW {};\n      +I    ;\n      T     #sum;",
            12 + 2 * index
        ));
    }
    line(format_args!(
        "      L     MW {};\n      L     W#16#FF0F;\n      AW    ;\n      T     DB{data}.DBW 10;",
        memory + 8
    ));
    line(format_args!("      L     #sum;\n      L     {setpoint};\n      -I    ;\n      T     DB{data}.DBW 26;"));
    line(format_args!("      A     OV;\n      S     M {}.6;\n      BE    ;\nEND_FUNCTION", memory + 8));
    text
}
