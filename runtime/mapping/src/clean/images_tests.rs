//! Pictures whose boxes cannot be used, each refused whole.

use floorguard_mapping::people_removal::{BrownLens, LensCamera, PersonBox, PositionMethod};
use floorguard_types::geometry::Transform3;
use floorguard_types::sensing::{PinholeCamera, Pixel};

use super::{ImageBoxes, ImageError, PeopleInImages, SizedCamera};

fn camera() -> SizedCamera {
    let pinhole = PinholeCamera::new([320.0; 2], [320.0, 240.0]).unwrap();
    let camera = LensCamera::new(pinhole, BrownLens::default(), Transform3::IDENTITY).unwrap();
    SizedCamera { camera, size: [640, 480] }
}

fn image(stamp_s: f64, size: Option<[u32; 2]>, right: f32) -> ImageBoxes {
    let person = PersonBox {
        confidence: 0.9,
        upper_left: Pixel { column: 10.0, row: 10.0 },
        lower_right: Pixel { column: right, row: 200.0 },
    };
    ImageBoxes { stamp_s, size, boxes: vec![person] }
}

#[test]
fn unusable_boxes_are_refused_with_their_picture() {
    let size = [640, 480];
    let new = |second: ImageBoxes| {
        let images = vec![image(1.0, Some(size), 100.0), second];
        PeopleInImages::new(camera(), images, PositionMethod::DepthMode).map(|images| images.pictures())
    };
    assert_eq!(new(image(1.1, None, 100.0)), Ok(2));
    assert_eq!(new(image(0.9, None, 100.0)), Err(ImageError::OutOfOrder { number: 2, stamp_s: 0.9 }));
    let (is, calibrated) = ([1_280, 720], size);
    assert_eq!(new(image(1.1, Some(is), 100.0)), Err(ImageError::OtherSize { number: 2, is, calibrated }));
    // Without a size the boxes themselves show that the picture was another one.
    let outside = ImageError::Outside { number: 2, column: 900.0, row: 200.0, size };
    assert_eq!(new(image(1.1, None, 900.0)), Err(outside));
    for wrong in [image(f64::NAN, None, 100.0), image(1.1, None, f32::INFINITY)] {
        assert_eq!(new(wrong), Err(ImageError::NotFinite { number: 2 }));
    }
}
