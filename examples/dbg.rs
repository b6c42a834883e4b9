use sidc::{data::*, lang::source::Sources, pipeline};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut s = Sources::default();
    let f = s.add("m", std::fs::read_to_string(&a[1]).unwrap());
    let (p, _) = pipeline::compile(f, &s);
    let p = p.unwrap();
    let t: Vec<Table> = a[2..]
        .iter()
        .map(|x| {
            read(
                x,
                std::fs::File::open(x).unwrap(),
                &Limits::default(),
                &mut s,
            )
            .unwrap()
        })
        .collect();
    let (m, _) = pipeline::measure(&p, &t, &[], (None, None), &mut s);
    let m = m.unwrap();
    for c in &m.samples.columns {
        if let Origin::Estimated { error, .. } = &c.origin {
            println!("{:?}", c.signal);
            for i in 0..m.samples.len() {
                println!("{} {:e} {:e}", m.samples.time[i], c.values[i], error[i]);
            }
        }
    }
}
