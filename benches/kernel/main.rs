//! The kernel by itself, with criterion: bench study, its parts, and the separable full grid.

mod study;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use cyclosweep::Output;
use cyclosweep::sampling::Rows;

/// Variants a measurement: enough for every thread, small enough for the allocator's cache.
const BATCH: usize = 1 << 17;

fn kernel(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("kernel");
    group.throughput(Throughput::Elements(BATCH as u64));
    group.sample_size(20);
    for (name, study) in [("sobol", study::sobol()), ("grid", study::grid())] {
        let every = Output::all(study.loads());
        let compliance: Vec<Output> = every
            .iter()
            .copied()
            .filter(|output| is_compliance_or_twist(*output))
            .collect();
        for (columns, outputs) in [("every column", &every), ("compliance, twist", &compliance)] {
            group.bench_function(format!("{name}, {columns}"), |bench| {
                bench.iter(|| {
                    study
                        .evaluate(Rows::From(0), BATCH, outputs)
                        .expect("rows of the study")
                });
            });
        }
    }
    group.finish();
}

fn is_compliance_or_twist(output: Output) -> bool {
    matches!(
        output,
        Output::OutputCompliance
            | Output::ReflectedCompliance
            | Output::ReflectedStiffness
            | Output::OutputStiffness
            | Output::Twist(_)
    )
}

criterion_group!(benches, kernel);
criterion_main!(benches);
