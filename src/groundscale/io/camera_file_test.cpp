#include "groundscale/io/camera_file.hpp"

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/camera/ocam.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;

constexpr const char* kCalib =
    "P0: 718.856 0 607.1928 0 0 718.856 185.2157 0 0 0 1 0\n"
    "P1: 718.856 0 607.1928 -386.1448 0 718.856 185.2157 0 0 0 1 0\n";
constexpr const char* kPinhole = "model: pinhole\nfx: 700\nfy: 710\ncx: 320\ncy: 240\n";

const PinholeParameters& parameters_of(const CameraSetup& setup) {
  return dynamic_cast<const PinholeCamera&>(*setup.camera).parameters();
}

std::string camera_error(const std::string& content, int width = 640, int height = 480) {
  const TempFolder folder;
  const Result<CameraSetup> setup = read_camera_file(folder.file("camera.yaml", content), width, height);
  if (setup) return "no error";
  EXPECT_EQ(setup.error().code, ErrorCode::kBadInput);
  return setup.error().message;
}

std::string calib_error(const std::string& content, int image = 0) {
  const TempFolder folder;
  const Result<CameraSetup> setup = read_kitti_calibration(folder.file("calib.txt", content), image, 1241, 376);
  if (setup) return "no error";
  EXPECT_EQ(setup.error().code, ErrorCode::kBadInput);
  return setup.error().message;
}

TEST(KittiCalibration, RowOfTheChosenImageIsThePinhole) {
  const TempFolder folder;
  const Result<CameraSetup> setup = read_kitti_calibration(folder.file("calib.txt", kCalib), 1, 1241, 376);
  ASSERT_TRUE(setup);
  EXPECT_EQ(parameters_of(*setup).fx, 718.856);
  EXPECT_EQ(parameters_of(*setup).fy, 718.856);
  EXPECT_EQ(parameters_of(*setup).cx, 607.1928);
  EXPECT_EQ(parameters_of(*setup).cy, 185.2157);
  EXPECT_EQ(setup->camera->width(), 1241);
  EXPECT_EQ(setup->camera->height(), 376);
  EXPECT_FALSE(setup->height_m);
  EXPECT_FALSE(setup->pitch_rad);
}

TEST(KittiCalibration, ErrorsNameFileLineRowAndValue) {
  EXPECT_THAT(calib_error("P0: 1 2 3\n"), HasSubstr("calib.txt:1: P0: 3 values, it must have 12"));
  EXPECT_THAT(calib_error("\nP0: nan 0 607 0 0 718 185 0 0 0 1 0\n"), HasSubstr("calib.txt:2: P0: value 1 is 'nan'"));
  EXPECT_THAT(calib_error("P0: -718 0 607 0 0 718 185 0 0 0 1 0\n"),
              HasSubstr("calib.txt:1: P0: fx is -718, a focal length must be above 0"));
  EXPECT_THAT(calib_error("P0: 718 0 1607 0 0 718 185 0 0 0 1 0\n"), HasSubstr("outside the images of 1241x376"));
  EXPECT_THAT(calib_error("P0: 718 1 607 0 0 718 185 0 0 0 1 0\n"), HasSubstr("isn't [fx 0 cx"));
  EXPECT_THAT(calib_error(kCalib, 3), HasSubstr("calib.txt: has no row 'P3:'"));
  EXPECT_THAT(calib_error(""), HasSubstr("has no row 'P0:'"));
}

TEST(KittiCalibration, AMissingFileIsBadInput) {
  const auto setup = read_kitti_calibration("/no/such/calib.txt", 0, 1241, 376);
  ASSERT_FALSE(setup);
  EXPECT_EQ(setup.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(setup.error().message, HasSubstr("/no/such/calib.txt: can't be opened"));
}

TEST(CameraFile, ReadsEveryKey) {
  const TempFolder folder;
  const std::string text =
      "model: pinhole\nimage_size: [640, 480]\nfx: 700.5\nfy: 710\ncx: 320\ncy: 240\n"
      "distortion: {k1: -0.1, k2: 0.01, p1: 0.001, p2: -0.002, k3: 0.0005}\n"
      "height_m: 1.4\npitch_deg: 3\nroll_deg: -1\nyaw_deg: 0.5\n"
      "vehicle_mask:\n  polygon: [[0, 479], [639, 479], [639, 400], [0, 400]]\n";
  const Result<CameraSetup> setup = read_camera_file(folder.file("camera.yaml", text), 640, 480);
  ASSERT_TRUE(setup) << setup.error().message;
  const PinholeParameters& p = parameters_of(*setup);
  EXPECT_EQ(p.fx, 700.5);
  EXPECT_EQ(p.fy, 710.0);
  EXPECT_EQ(p.cx, 320.0);
  EXPECT_EQ(p.cy, 240.0);
  EXPECT_EQ(p.k1, -0.1);
  EXPECT_EQ(p.k2, 0.01);
  EXPECT_EQ(p.p1, 0.001);
  EXPECT_EQ(p.p2, -0.002);
  EXPECT_EQ(p.k3, 0.0005);
  EXPECT_EQ(setup->height_m, 1.4);
  EXPECT_NEAR(*setup->pitch_rad, 3.0 * M_PI / 180.0, 1e-15);
  EXPECT_NEAR(*setup->roll_rad, -M_PI / 180.0, 1e-15);
  EXPECT_NEAR(*setup->yaw_rad, 0.5 * M_PI / 180.0, 1e-15);
  EXPECT_EQ(setup->vehicle_mask.at(0, 399), 0);
  EXPECT_EQ(setup->vehicle_mask.at(0, 400), 255);
  EXPECT_EQ(setup->vehicle_mask.at(639, 479), 255);
}

TEST(CameraFile, WhatIsLeftOutIsEmptyAndTheSizeIsTheImages) {
  const TempFolder folder;
  const Result<CameraSetup> setup = read_camera_file(folder.file("camera.yaml", kPinhole), 640, 480);
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->camera->width(), 640);
  EXPECT_EQ(setup->camera->height(), 480);
  EXPECT_EQ(parameters_of(*setup).k1, 0.0);
  EXPECT_FALSE(setup->height_m);
  EXPECT_FALSE(setup->pitch_rad);
  EXPECT_FALSE(setup->roll_rad);
  EXPECT_FALSE(setup->yaw_rad);
  EXPECT_TRUE(setup->vehicle_mask.empty());
}

TEST(CameraFile, WhatIsWrittenReadsBackToTheSameValues) {
  const TempFolder folder;
  CameraSetup setup;
  setup.camera =
      *PinholeCamera::create({718.856, 700.1, 607.1928, 185.2157, 0.1, 1e-7, 1.0 / 3.0 * 1e-3, 0.0, 0.0}, 1241, 376);
  setup.height_m = 1.0 / 3.0;
  setup.pitch_rad = 2.5 * M_PI / 180.0;
  setup.vehicle_mask = Image(1241, 376);
  for (int k = 0; k < 1241 * 376; ++k) setup.vehicle_mask.data()[k] = k % 7 == 0 ? 255 : 0;
  setup.height_sd_m = 0.007;
  ASSERT_TRUE(write_camera_file(folder / "camera.yaml", setup, "where it came from\nand how: twice"));
  EXPECT_THAT(read_text(folder / "camera.yaml").value(),
              testing::StartsWith("# where it came from\n# and how: twice\nmodel: pinhole\n"));
  const Result<CameraSetup> back = read_camera_file(folder / "camera.yaml", 1241, 376);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(parameters_of(*back).fx, parameters_of(setup).fx);
  EXPECT_EQ(parameters_of(*back).cy, parameters_of(setup).cy);
  EXPECT_EQ(parameters_of(*back).k2, parameters_of(setup).k2);
  EXPECT_EQ(parameters_of(*back).p1, parameters_of(setup).p1);
  EXPECT_EQ(back->height_m, setup.height_m);
  EXPECT_EQ(back->height_sd_m, setup.height_sd_m);
  EXPECT_DOUBLE_EQ(*back->pitch_rad, *setup.pitch_rad);
  EXPECT_FALSE(back->roll_rad);
  EXPECT_EQ(std::string_view(reinterpret_cast<const char*>(back->vehicle_mask.data()), 1241 * 376),
            std::string_view(reinterpret_cast<const char*>(setup.vehicle_mask.data()), 1241 * 376));
}

TEST(CameraFile, ErrorsNameFileLineKeyAndBound) {
  const std::string pinhole = kPinhole;
  EXPECT_THAT(camera_error(pinhole + "heigth_m: 1.6\n"),
              HasSubstr("camera.yaml:6: unknown key 'heigth_m', the nearest is 'height_m'"));
  EXPECT_THAT(camera_error(pinhole + "distortion: {k4: 1}\n"),
              HasSubstr("camera.yaml:6: distortion: unknown key 'k4', the nearest is 'k1'"));
  EXPECT_THAT(camera_error(pinhole + "fx: 1\n"), HasSubstr("camera.yaml:6: key 'fx' is there twice"));
  EXPECT_THAT(camera_error("model: pinhole\nfx: 700\nfy: 710\ncx: 320\n"), HasSubstr("cy is missing"));
  EXPECT_THAT(camera_error("model: pinhole\nfx: -700\nfy: 710\ncx: 320\ncy: 240\n"),
              HasSubstr("camera.yaml:2: fx: -700, a focal length must be above 0"));
  EXPECT_THAT(camera_error("model: pinhole\nfx: .nan\nfy: 710\ncx: 320\ncy: 240\n"),
              HasSubstr("camera.yaml:2: fx: '.nan' must be a finite number"));
  EXPECT_THAT(camera_error(pinhole + "height_m: 0\n"), HasSubstr("height_m: 0 is out of range, it must be above 0"));
  EXPECT_THAT(camera_error(pinhole + "height_m: -1\n"), HasSubstr("height_m: -1 is out of range"));
  EXPECT_THAT(camera_error(pinhole + "height_m: 1\nheight_sd_m: -1\n"), HasSubstr("height_sd_m: -1 is out of range"));
  EXPECT_THAT(camera_error(pinhole + "height_sd_m: 0.01\n"), HasSubstr("height_sd_m: is there without height_m"));
  EXPECT_THAT(camera_error(pinhole + "pitch_deg: 100\n"), HasSubstr("from -90 to 90 degrees"));
  EXPECT_THAT(camera_error(pinhole + "image_size: [1241, 376]\n"),
              HasSubstr("camera.yaml:6: image_size: 1241x376, but the images are 640x480"));
  EXPECT_THAT(camera_error(pinhole + "image_size: [1241]\n"), HasSubstr("must be a list of 2 numbers"));
  EXPECT_THAT(camera_error(pinhole + "image_size: [640.5, 480]\n"), HasSubstr("640.5 must be a whole number"));
  EXPECT_THAT(camera_error(pinhole, 0, 0), HasSubstr("image_size is missing"));
  EXPECT_THAT(camera_error(pinhole + "vehicle_mask: {polygon: [[0, 0], [1, 1]]}\n"), HasSubstr("at least 3 corners"));
  EXPECT_THAT(camera_error(pinhole + "vehicle_mask: {image: none.png}\n"), HasSubstr("none.png: can't be opened"));
  EXPECT_THAT(camera_error(pinhole + "vehicle_mask: {}\n"), HasSubstr("either polygon or image"));
  EXPECT_THAT(camera_error(pinhole + "distortion: {k1: -5}\n"), HasSubstr("folds back inside the image"));
}

TEST(CameraFile, AnUnknownModelNamesTheKnownOnes) {
  EXPECT_THAT(camera_error("model: pinhoel\n"),
              HasSubstr("camera.yaml:1: model: 'pinhoel' is no camera model, known: pinhole, kannala_brandt, ocam"));
  EXPECT_THAT(camera_error("fx: 700\n"), HasSubstr("model is missing, known: pinhole"));
}

TEST(CameraFile, EveryModelReadsAndWritesItsOwnKeys) {
  const TempFolder folder;
  const std::string kannala_brandt =
      "model: kannala_brandt\nimage_size: [640, 480]\nfx: 250.5\nfy: 251\ncx: 320\ncy: 240\n"
      "distortion: {k1: 0.01, k2: -0.002, k3: 0.0003, k4: 0}\n";
  const std::string ocam =
      "model: ocam\nimage_size: [640, 480]\npolynomial: [-250.5, 0, 0.0012]\ncx: 321\ncy: 239\n"
      "affine: {c: 1.001, d: 0.0002, e: -0.0003}\n";
  for (const std::string& text : {kannala_brandt, ocam}) {
    const auto setup = read_camera_file(folder.file("camera.yaml", text), 640, 480);
    ASSERT_TRUE(setup) << setup.error().message;
    const std::string written = folder / "written.yaml";
    ASSERT_TRUE(write_camera_file(written, *setup));
    EXPECT_EQ(*read_text(written), text);
  }
}

TEST(CameraFile, StandardDeviationsAreReadAndWrittenUnderTheModelsNames) {
  const TempFolder folder;
  const std::string sds = "f_sd: 2.5\ncx_sd: 10\ncy_sd: 0.8\n";
  const std::string kannala_brandt =
      "model: kannala_brandt\nimage_size: [640, 480]\nfx: 250.5\nfy: 251\ncx: 320\ncy: 240\n"
      "distortion: {k1: 0.01, k2: -0.002, k3: 0.0003, k4: 0}\n" +
      sds + "k1_sd: 0.0015\n";
  const std::string ocam =
      "model: ocam\nimage_size: [640, 480]\npolynomial: [-250.5, 0, 0.0012]\ncx: 321\ncy: 239\n"
      "affine: {c: 1.001, d: 0.0002, e: -0.0003}\n" +
      sds + "polynomial_2_sd: 3.5e-06\n";
  for (const std::string& text : {kannala_brandt, ocam, kPinhole + sds + "k1_sd: 0.0015\n"}) {
    const auto setup = read_camera_file(folder.file("camera.yaml", text), 640, 480);
    ASSERT_TRUE(setup) << setup.error().message;
    const bool is_ocam = setup->camera->model() == "ocam";
    const std::map<CameraParameter, double> expected = {{CameraParameter::kFocal, 2.5},
                                                        {CameraParameter::kColumn, 10.0},
                                                        {CameraParameter::kRow, 0.8},
                                                        {CameraParameter::kRadial, is_ocam ? 3.5e-6 : 0.0015}};
    EXPECT_EQ(setup->parameter_sds, expected);
    const std::string written = folder / "written.yaml";
    ASSERT_TRUE(write_camera_file(written, *setup));
    EXPECT_EQ(read_camera_file(written, 640, 480).value().parameter_sds, expected);
    if (setup->camera->model() != "pinhole") {
      EXPECT_EQ(*read_text(written), text);
    }
  }
}

TEST(CameraFile, AStandardDeviationIsANumberAboveZeroOfThisModel) {
  const std::string pinhole = kPinhole;
  EXPECT_THAT(camera_error(pinhole + "f_sd: 0\n"),
              HasSubstr("camera.yaml:6: f_sd: 0 is out of range, it must be above 0"));
  EXPECT_THAT(camera_error(pinhole + "cx_sd: -1\n"), HasSubstr("cx_sd: -1 is out of range, it must be above 0"));
  EXPECT_THAT(camera_error(pinhole + "cy_sd: much\n"), HasSubstr("cy_sd: 'much' must be a finite number"));
  EXPECT_THAT(camera_error(pinhole + "k1_sd: .inf\n"), HasSubstr("k1_sd: "));
  EXPECT_THAT(camera_error(pinhole + "polynomial_2_sd: 1\n"), HasSubstr("unknown key 'polynomial_2_sd'"));
  EXPECT_THAT(camera_error("model: ocam\ncx: 320\ncy: 240\npolynomial: [-250]\nk1_sd: 1\n"),
              HasSubstr("unknown key 'k1_sd'"));
}

TEST(CameraFile, ItsTextIsWhatIsWritten) {
  const TempFolder folder;
  CameraSetup setup = read_camera_file(folder.file("camera.yaml", kPinhole), 640, 480).value();
  setup.vehicle_mask = Image(640, 480);
  setup.vehicle_mask.data()[0] = 255;
  ASSERT_TRUE(write_camera_file(folder / "written.yaml", setup, "why"));
  EXPECT_EQ(*read_text(folder / "written.yaml"), camera_file_text(setup, "written_vehicle_mask.png", "why"));
  EXPECT_THAT(camera_file_text(setup, ""), testing::Not(HasSubstr("vehicle_mask")));
}

TEST(CameraFile, KeysOfAnotherModelAreUnknown) {
  EXPECT_THAT(camera_error("model: ocam\nfx: 700\n"), HasSubstr("unknown key 'fx'"));
  EXPECT_THAT(camera_error("model: kannala_brandt\nfx: 1\nfy: 1\ncx: 1\ncy: 1\ndistortion: {p1: 0}\n"),
              HasSubstr("unknown key 'p1'"));
  EXPECT_THAT(camera_error("model: ocam\ncx: 320\ncy: 240\n"), HasSubstr("polynomial is missing"));
  EXPECT_THAT(camera_error("model: ocam\ncx: 320\ncy: 240\npolynomial: [250]\n"), HasSubstr("it must be negative"));
}

constexpr const char* kOcamResults =
    "#polynomial coefficients for the DIRECT mapping function\n\n3 -2.505e+02 0.0 1.2e-03\n\n"
    "#polynomial coefficients for the inverse mapping function\n\n2 390.0 -120.0\n\n"
    "#center: \"row\" and \"column\", starting from 0 (C convention)\n\n239 321\n\n"
    "#affine parameters \"c\", \"d\", \"e\"\n\n1.001 0.0002 -0.0003\n\n"
    "#image size: \"height\" and \"width\"\n\n480 640\n";

TEST(OcamResults, AreReadAsTheToolboxWritesThem) {
  const TempFolder folder;
  const auto setup = read_camera_file(folder.file("calib_results.txt", kOcamResults), 640, 480);
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_FALSE(setup->height_m);
  const OcamParameters& p = dynamic_cast<const OcamCamera&>(*setup->camera).parameters();
  EXPECT_THAT(p.polynomial, testing::ElementsAre(-250.5, 0.0, 1.2e-3));
  EXPECT_THAT((std::vector{p.cx, p.cy, p.c, p.d, p.e}), testing::ElementsAre(321.0, 239.0, 1.001, 2e-4, -3e-4));
  // The toolbox has rows first and its third axis backwards: row 339 lies below, in front of the camera.
  const auto below = setup->camera->ray({321.0 + 100.0 * -3e-4, 239.0 + 100.0 * 1.001});
  ASSERT_TRUE(below);
  EXPECT_NEAR(below->x() / below->y(), 0.0, 1e-12);
  EXPECT_NEAR(below->z() / below->y(), (250.5 - 1.2e-3 * 1e4) / 100.0, 1e-12);
}

TEST(OcamResults, WhatIsNoneOrOfOtherImagesIsRefused) {
  const TempFolder folder;
  const auto message_of = [&folder](const std::string& text, int width) {
    const auto setup = read_camera_file(folder.file("calib_results.txt", text), width, 480);
    return setup ? std::string("taken") : setup.error().message;
  };
  EXPECT_THAT(message_of(kOcamResults, 641), HasSubstr("640x480, but the images are 641x480"));
  EXPECT_THAT(message_of("3 -250 0", 640), HasSubstr("ends before the polynomial"));
  EXPECT_THAT(message_of("2 -250 nan", 640), HasSubstr("calib_results.txt:1: 'nan' isn't a finite number"));
  EXPECT_THAT(message_of("2.5 1 1", 640), HasSubstr("the polynomial should be so many: 2.5"));
}

TEST(CameraFile, WhatIsNoYamlIsAnErrorWithItsLine) {
  EXPECT_THAT(camera_error("model: pinhole\nfx: [1, 2\n"), HasSubstr("camera.yaml:3: isn't YAML"));
  EXPECT_THAT(camera_error(""), HasSubstr("must hold keys"));
  EXPECT_THAT(camera_error("just words"), HasSubstr("must hold keys"));
}

TEST(CameraFile, AMaskImageCountsEverythingButZeroAndMustHaveTheSize) {
  const TempFolder folder;
  Image image(640, 480);
  std::fill_n(image.data(), 640 * 480, std::uint8_t{0});
  image.data()[5] = 1;
  ASSERT_TRUE(write_image(folder / "mask.png", image));
  const std::string text = std::string(kPinhole) + "vehicle_mask: {image: mask.png}\n";
  const Result<CameraSetup> setup = read_camera_file(folder.file("camera.yaml", text), 640, 480);
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->vehicle_mask.at(5, 0), 255);
  EXPECT_EQ(setup->vehicle_mask.at(6, 0), 0);
  ASSERT_TRUE(write_image(folder / "mask.png", Image(64, 48)));
  const Result<CameraSetup> wrong = read_camera_file(folder / "camera.yaml", 640, 480);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("the mask is 64x48, it must be 640x480"));
}

}  // namespace
}  // namespace groundscale
