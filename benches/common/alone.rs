//! Rays of light that share nothing.

const PATH: &str = "wgsl/pass/path.wgsl";
const SHARED: &str = "begin_opened(ray, reach, opened)";

/// The shaders in which each ray of light makes its first step by itself.
pub fn alone(path: &str) -> Option<String> {
    let text = include_str!("../../wgsl/pass/path.wgsl");
    assert!(text.contains(SHARED));
    (path == PATH).then(|| text.replace(SHARED, "begin(ray, 0.0, reach)"))
}
