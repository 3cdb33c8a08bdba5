//! `conemarch conemap`: a sentence and an exit code for everything that is wrong, and no file.

use std::fs;

use conemarch::heightfield::conemap::generate::generator::Generator;
use exr::prelude::FlatSamples;
use png::{BitDepth, ColorType};

use crate::commands::{make, slope, with_rock};
use crate::folder::{Folder, said};
use crate::pictures::{exr, png, wide};

/// Checks that command lines fail with a code and a sentence. Each line of the table has the
/// arguments after `conemap`, and behind `=>` the parts of the sentence, separated by `|`.
fn all_fail(folder: &Folder, code: i32, table: &str) {
    for row in table.trim().lines() {
        let (arguments, telling) = row.split_once("=>").expect("a row of a table");
        let mut line = format!("conemap {}", arguments.trim());
        if line.starts_with("conemap make") && !line.contains("--device") {
            line.push_str(" --device cpu");
        }
        folder.fails(&line, code, &telling.trim().replace(" | ", "|"));
    }
}

/// A PNG of another program with four channels.
fn theirs() -> Vec<u8> {
    png([4, 4], ColorType::Rgba, BitDepth::Eight, &[9; 4 * 16])
}

#[test]
fn a_map_never_takes_the_place_of_its_heights() {
    let folder = with_rock();
    make(&folder, "rock.png -o m.png");
    let before = folder.bytes("m.png");
    let table = "
        make rock.png -o rock.png      => rock.png | another name
        make rock.png -o ./rock.png    => rock.png | another name
        inspect rock.png -o rock.png   => rock.png | another name
        convert m.png -o m.png         => m.png | another name
    ";
    all_fail(&folder, 2, table);
    assert_eq!(folder.bytes("m.png"), before);
    assert_eq!(folder.bytes("rock.png"), slope());
}

#[test]
fn options_without_effect_are_wrong_usage() {
    let folder = with_rock();
    make(&folder, "sine:4x4 -o m.png");
    make(&folder, "sine:4x4 -o m.exr");
    folder.write("theirs.png", theirs());
    folder.done("conemap inspect theirs.png --from dummer --wrap x");
    let of_maps = "
        convert FILE -o a.exr --from relief   => FILE | --from | leave it out
        inspect FILE --from dummer            => FILE | --from | leave it out
        inspect FILE --wrap x                 => FILE | --wrap | --heights
        inspect FILE --invert                 => FILE | --invert | --heights
        inspect FILE --normalize              => FILE | --normalize | --heights
        inspect FILE --size 4x4               => FILE | --size | --heights
    ";
    for file in ["m.png", "m.exr"] {
        all_fail(&folder, 2, &of_maps.replace("FILE", file));
    }
    let table = "
        inspect theirs.png --from dummer --invert               => --invert | --heights
        inspect rock.png --heights rock.png                     => not a cone map
        make sine:4x4 --layout dummer --depth 3 -o a.png        => --depth | relief | dummer
        make sine:4x4 --layout pair --depth 3 -o a.png          => --depth | relief | pair
        make sine:4x4 --depth 3                                 => EXR | --depth
        convert m.exr -o a.png --depth 3                        => --depth | relief | dummer
        make sine:4x4 --layout pair --slopes half -o a.png      => --slopes | dummer | pair
        make sine:4x4 --layout relief --slopes half -o a.png    => --slopes | dummer | relief
        make sine:4x4 --slopes half                             => EXR | --slopes
    ";
    all_fail(&folder, 2, table);
}

#[test]
fn wrong_usage_is_exit_code_2() {
    let folder = Folder::new();
    make(&folder, "sine:4x4 -o m.exr");
    let table = "
        make fbm:4x4 --generator quick               => quick | GENERATORS
        make fbm:4x4 --wrap z                        => --wrap | none, x, y, xy
        make fbm:4x4 -o a.jpg                        => `a.jpg` | .png | .exr
        make fbm:4x4 -o a.exr --bits 8               => EXR | --bits
        make fbm:4x4 -o a.exr --layout pair          => EXR | --layout
        make fbm:4x4 -o a.png --layout full          => dummer, relief, pair, quad
        make fbm:4x4 -o a.png --layout quad          => `quad` | four ratios
        make fbm:4x4 -o a.png --bits 12              => --bits | 8, 16
        make fbm:4x4 --depth 0                       => --depth | 0.001 to 1000
        make fbm:4x4 --offset 2                      => --offset | walk | exact
        make fbm:4x4 --boxes                         => --boxes | walk
        make fbm:4x4 --search-steps 9                => --search-steps | relaxed-search
        make fbm:4x4 --generator walk --offset 0     => an offset of 0
        make fbm:4x4 --generator walk --offset nan   => an offset of NaN
        make fbm:4x4 --size 4x4                      => fbm:4x4 | --size
        make fbm:4x4 --size 9000x1                   => --size | 8192
        make fmb:4x4                                 => fmb:4x4 | fields are fbm, ridges
        make fbm:4x4,seed=x                          => seed=x
        inspect nothing                              => nothing | fields are fbm
        inspect m.exr -o a.exr                       => a.exr | .png
        convert m.exr                                => -o MAP.png
        convert m.exr -o a.bmp                       => a.bmp
        convert m.exr -o a.png --wrap x              => --from
    ";
    let generators = Generator::ALL.map(Generator::name).join(", ");
    all_fail(&folder, 2, &table.replace("GENERATORS", &generators));
    folder.fails("conemap", 2, "a command is missing");
}

#[test]
fn bad_heights_are_exit_code_1() {
    let folder = Folder::new();
    let one = |z: f32| exr([2, 1], vec![("Y", FlatSamples::F32(vec![0.5, z]))]);
    folder.write("nan.exr", one(f32::NAN));
    folder.write("inf.exr", one(f32::INFINITY));
    folder.write("metres.exr", one(812.5));
    folder.write("empty.png", []);
    folder.write("cut.png", &slope()[..60]);
    folder.write("text.png", "heights");
    folder.write("short-4x4.raw", [0; 12]);
    fs::create_dir(folder.0.join("folder.png")).expect("a folder");
    let table = "
        VERB nan.exr         => nan.exr: the height at column 1, row 0 is NaN
        VERB inf.exr         => inf.exr: the height at column 1, row 0 is inf
        VERB metres.exr      => from 0.5 to 812.5 | --normalize
        VERB empty.png       => empty.png: is empty
        VERB cut.png         => cut.png: is a PNG that ends before its end
        VERB text.png        => text.png: is neither PNG, EXR nor TIFF
        VERB short-4x4.raw   => has 12 bytes | 64
        VERB folder.png      => folder.png: is a folder
        VERB missing.png     => missing.png: cannot be read
    ";
    for verb in ["make -o m.exr", "inspect -o m.png"] {
        all_fail(&folder, 1, &table.replace("VERB", verb));
    }
    make(&folder, "metres.exr --normalize -o m.exr");
    // Alpha is not a height, and a note says so.
    let alpha = wide(&[13107, 0, 65535, 65535]);
    let alpha = png([2, 1], ColorType::GrayscaleAlpha, BitDepth::Sixteen, &alpha);
    folder.write("ga.png", alpha);
    let said = said(&make(&folder, "ga.png -o m.exr"));
    assert!(said.contains("note: ga.png is transparent"), "{said}");
}

#[test]
fn bad_maps_and_places_are_exit_code_1() {
    let folder = with_rock();
    make(&folder, "rock.png -o m.png");
    let map = folder.bytes("m.png");
    folder.write("cut.png", &map[..map.len() * 2 / 3]);
    folder.write("text.txt", "nothing");
    folder.write("old.exr", "precious");
    fs::create_dir(folder.0.join("folder.png")).expect("a folder");
    let table = "
        convert rock.png -o b.exr                 => rock.png | conemap make | --from
        convert cut.png -o b.exr                  => cut.png | ends before its end
        inspect cut.png                           => cut.png | ends before its end
        convert text.txt -o b.exr                 => text.txt | PNG or EXR
        convert missing.png -o b.exr              => missing.png: cannot be read
        convert rock.png -o b.exr --from dummer   => rock.png | 1 channels
        make rock.png -o no/b.exr                 => no/b.exr | no folder `no`
        convert m.png -o no/b.exr                 => no/b.exr | no folder `no`
        make rock.png -o folder.png               => is a folder
        inspect m.png -o no/a.png                 => no/a.png
        make sine:4x4 --device 99                 => there is no adapter | 99 | cpu
        make cut.png -o old.exr                   => cut.png
    ";
    all_fail(&folder, 1, table);
    // What was there stays, whatever fails.
    assert_eq!(folder.bytes("old.exr"), b"precious");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let folder = Folder::new();
    std::os::unix::fs::symlink("/dev/full", folder.0.join("full.exr")).expect("a link");
    let row = "make sine:8x8 -o full.exr => full.exr | No space left";
    all_fail(&folder, 1, row);
}
