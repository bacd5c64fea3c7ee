//! What callgrind counts: the bench study once, `columns` of it, over as many variants as asked.
//!
//! `instructions every|compliance|grid VARIANTS`; two sizes give the cost of a variant without
//! that of the process.

mod study;

use cyclosweep::Output;
use cyclosweep::sampling::Rows;

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|word| word != "--bench");
    let (Some(what), Some(count)) = (arguments.next(), arguments.next()) else {
        // `cargo bench` runs every bench target; this one has nothing to say by itself.
        return;
    };
    let count: usize = count.parse().expect("a number of variants");
    let study = if what.starts_with("grid") {
        study::grid()
    } else {
        study::sobol()
    };
    let outputs: Vec<Output> = Output::all(study.loads())
        .into_iter()
        .filter(|output| {
            !what.ends_with("compliance")
                || matches!(
                    output,
                    Output::OutputCompliance
                        | Output::ReflectedCompliance
                        | Output::ReflectedStiffness
                        | Output::OutputStiffness
                        | Output::Twist(_)
                )
        })
        .collect();
    let columns = study
        .evaluate(Rows::From(0), count, &outputs)
        .expect("rows of the study");
    std::hint::black_box(columns);
}
