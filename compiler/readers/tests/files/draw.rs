//! Drawings of networks.

use crate::notation::network;
use plcc_syntax::network::ast::Language;
use plcc_syntax::network::draw::draw;

fn check(language: Language, lines: &[&str], mark: Option<usize>, drawing: &str) {
    let drawn = draw(&network(language, lines), mark);
    assert_eq!(drawn.trim_end(), drawing.trim_matches('\n').trim_end(), "\n{drawn}");
}

#[test]
fn seal_in() {
    check(
        Language::Lad,
        &["rail < Contact #Start > w1", "rail < Contact #Motor > w1", "w1 < I_Contact #Stop > w2", "w2 < Coil #Motor"],
        Some(2),
        r#"
|   #Start       #Stop       #Motor
|----| |-----+----|/|---------( )
|            |   ^^^^^
|   #Motor   |
|----| |-----+
"#,
    );
}

#[test]
fn nested_branches() {
    check(
        Language::Lad,
        &[
            "rail < Contact #a > w1",
            "w1 < Contact #b > w2",
            "w1 < I_Contact #c > w2",
            "rail < Contact #d > w2",
            "w2 < Coil #q1",
            "w1 < Contact #e > w3",
            "w3 < S_Coil #q2",
        ],
        Some(5),
        r#"
|   #a        #b        #q1
|---| |---+---| |---+---( )
|         |   #c    |
|         +---|/|---+
|   #d    |         |
|---| |-------------+
          |   #e        #q2
          +---| |-------(S)
              ^^^
"#,
    );
}

#[test]
fn boxes_with_pins() {
    check(
        Language::Lad,
        &[
            "rail < Contact #Cause > w3",
            "w3 < #Delay.TON pt=T#2s et= > w1",
            "rail < Contact #Ack > w4",
            "w4 < I_Contact #Cause > w5",
            "w5 < S_RS operand=#Alarm s1=w1 > w6",
            "w6 < Coil #Lamp",
        ],
        None,
        r#"
                       #Delay
|   #Cause             +-TON-+
|----| |---------------|in  q|-----+ w1
|                T#2s--|pt et|--
|                      +-----+
|
|   #Ack       #Cause               +--S_RS---+         #Lamp
|---| |---------|/|-----------------|r       q|----------( )
                            #Alarm--|operand  |
                                w1--|s1       |
                                    +---------+
"#,
    );
    check(
        Language::Lad,
        &[
            "rail < Contact #On > w1",
            "w1 < Normalize min=0 value=#raw max=27648 out=#n > w2",
            "w2 < GT_Contact in1=#n in2=0.9 > w3",
            "w3 < Coil \"High\"",
        ],
        Some(1),
        r#"
|   #On              +Normalize+           #n        "High"
|---| |--------------|en    eno|-----------|>|--------( )
                  0--|min   out|--#n       0.9
               #raw--|value    |
              27648--|max      |
                     +---------+
              ^^^^^^^^^^^^^^^^^^^^^^
"#,
    );
}

#[test]
fn gates() {
    check(
        Language::Fbd,
        &["#c < O in2=#d > w1", "#a < A in2=!#b in3=w1 > w2", "w2 < Coil #q"],
        Some(1),
        r#"
           +-->=1--+
 #c--------|in1 out|-----+ w1
       #d--|in2    |
           +-------+

           +---&---+         #q
 #a--------|in1 out|---------[=]
       #b-o|in2    |
       w1--|in3    |
           +-------+
       ^^^^^^^^^^^^^^^
"#,
    );
}

#[test]
fn what_makes_no_sense_is_drawn_too() {
    check(
        Language::Lad,
        &["rail < Contact #a > w1", "rail < > w1", "w1 < Coil #q"],
        Some(0),
        r#"
|   #a        #q
|---| |---+---( )
|   ^^^   |
|         |
|---------+
"#,
    );
    check(
        Language::Lad,
        &["w2 < Contact #a > w1", "w1 < Contact #b > w2", "w1 < Coil"],
        Some(2),
        r#"
                        #a
                    +---| |---> w1
              #b    |
          +---| |---+
          |   <??.?>
          +----( )
              ^^^^^^
"#,
    );
    check(
        Language::Lad,
        &["w9 < Contact #a > w1"],
        None,
        r#"
          #a
<??.?>----| |----
"#,
    );
    check(
        Language::Lad,
        &[],
        None,
        r#"
"#,
    );
}

#[test]
fn long_networks_are_cut_around_the_mark() {
    let lines: Vec<String> = (0..500).map(|at| format!("w{at} < Contact #x{at} > w{}", at + 1)).collect();
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let drawn = draw(&network(Language::Lad, &lines), Some(250));
    assert!(drawn.contains("#x250") && !drawn.contains("#x300"), "{drawn}");
    assert!(drawn.len() < 1000 && drawn.contains("^^^^^"), "{drawn}");
    let lines: Vec<String> = (0..500).map(|at| format!("w1 < Contact #x{at} > w2")).collect();
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    assert!(draw(&network(Language::Lad, &lines), Some(499)).contains("#x499"));
}
