//! A target holds the whole new file, or the old one untouched.

use std::path::{Path, PathBuf};

use ndf_inspector::image_io::{
    RasterImage, Samples, read, write_bytes_atomically, write_png_rgb8, write_png_rgb16, write_png_rgba8,
};

use super::files::{HEIGHT, WIDTH, colors16, folder};

#[test]
fn what_is_written_is_read_back() {
    let folder = folder();
    let path = folder.path().join("a.png");
    let read_back = |path: &PathBuf| -> RasterImage { read(path).unwrap() };
    let rgba: Vec<u8> = (0..WIDTH * HEIGHT * 4).map(|index| (index * 3) as u8).collect();
    write_png_rgba8(&path, WIDTH, HEIGHT, &rgba).unwrap();
    assert_eq!(read_back(&path).samples, Samples::U8(rgba));
    write_png_rgb16(&path, WIDTH, HEIGHT, &colors16()).unwrap();
    assert_eq!(read_back(&path).samples, Samples::U16(colors16()));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside the file");
}

#[test]
fn a_target_that_cannot_be_written_is_named_and_left_whole() {
    let folder = folder();
    let sentence = |path: &Path| write_bytes_atomically(path, b"new").unwrap_err().to_string();
    assert!(sentence(&folder.path().join("no/such/a.png")).ends_with("its folder does not exist"));
    assert!(sentence(folder.path()).ends_with("it is a folder"));

    let path = folder.path().join("kept.png");
    std::fs::write(&path, b"old").unwrap();
    let mut permissions = std::fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).unwrap();
    assert!(sentence(&path).ends_with("kept.png' cannot be written: there is no permission to write there"));
    assert_eq!(std::fs::read(&path).unwrap(), b"old");

    let error = write_png_rgb8(&path, 2, 2, &[0; 3]).unwrap_err().to_string();
    assert!(error.ends_with("3 samples do not make 2x2 texels"), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_called_by_name() {
    let error = write_bytes_atomically(Path::new("/dev/full"), b"new").unwrap_err().to_string();
    assert_eq!(error, "'/dev/full' cannot be written: the disk is full");
}

#[cfg(unix)]
#[test]
fn a_symbolic_link_keeps_pointing_where_it_did() {
    let folder = folder();
    let (file, link) = (folder.path().join("file"), folder.path().join("link"));
    std::fs::write(&file, b"old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    write_bytes_atomically(&link, b"new").unwrap();
    assert_eq!(std::fs::read(&file).unwrap(), b"new");
    assert!(link.symlink_metadata().unwrap().is_symlink());
}
