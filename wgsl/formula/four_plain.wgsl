// The estimates of a formula at four points, one after the other.

fn estimate_four(p: Points, most: u32) -> real4 {
    return real4(
        estimate(real3(p.x.x, p.y.x, p.z.x), most),
        estimate(real3(p.x.y, p.y.y, p.z.y), most),
        estimate(real3(p.x.z, p.y.z, p.z.z), most),
        estimate(real3(p.x.w, p.y.w, p.z.w), most),
    );
}
