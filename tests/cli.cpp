// The `pac` command as its users meet it: help, mistakes, exit codes, pipes, files.
#include <doctest/doctest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "base/kernels/kernels.h"
#include "tests/support/json_check.h"
#include "tests/support/run_cli.h"

using pac::test::CliFolder;
using pac::test::CliRun;
using pac::test::json_leaves;

namespace {

// A small, quick picture.
constexpr const char* kSmall = "render cubes --width 64 --height 48 --samples 1 ";

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The command names that `pac --help` lists.
std::vector<std::string> commands(const CliFolder& folder) {
  std::vector<std::string> names;
  const std::string help = folder.pac("--help").out;
  for (size_t at = help.find("\n  "); at != std::string::npos; at = help.find("\n  ", at + 1)) {
    const std::string line = help.substr(at + 3, help.find('\n', at + 1) - at - 3);
    names.push_back(line.substr(0, line.find("  ")));
  }
  return names;
}

void check_usage_error(const CliRun& run, const std::string& part) {
  CAPTURE(run.err);
  CHECK(run.code == 2);
  CHECK(run.out == "");
  CHECK(contains(run.err, part));
}

double number(const std::map<std::string, std::string>& leaves, const std::string& key) {
  CAPTURE(key);
  REQUIRE(leaves.contains(key));
  return std::strtod(leaves.at(key).c_str(), nullptr);
}

std::map<std::string, std::string> json(const CliRun& run) {
  CAPTURE(run.err);
  CAPTURE(run.out);
  CHECK(run.code == 0);
  const auto leaves = json_leaves(run.out);
  REQUIRE(leaves.has_value());
  return *leaves;
}

}  // namespace

TEST_CASE("every command explains itself with an example that starts with its own name") {
  const CliFolder folder;
  const auto names = commands(folder);
  CHECK(names.size() >= 12);
  for (const std::string& name : names) {
    CAPTURE(name);
    const CliRun run = folder.pac(name + " --help");
    CHECK(run.code == 0);
    CHECK(run.err == "");
    CHECK(contains(run.out, "usage: pac " + name));
    CHECK(contains(run.out, "example:\n  pac " + name));
    for (const char* option : {"--json", "--quiet", "--threads", "--isa"}) CHECK(contains(run.out, option));
  }
  CHECK(folder.pac("jpeg --help").code == 0);
}

TEST_CASE("mistyped commands, options and values get the nearest right one suggested") {
  const CliFolder folder;
  check_usage_error(folder.pac("rendr room"), "did you mean 'render'?");
  check_usage_error(folder.pac("jpeg encod"), "did you mean 'jpeg encode'?");
  check_usage_error(folder.pac("render room --widht 3 -o a.png"), "did you mean --width?");
  check_usage_error(folder.pac("jpeg encode a.png --qualty=3 -o a.jpg"), "did you mean --quality?");
  check_usage_error(folder.pac("render room --shading gourad -o a.png"), "did you mean 'gouraud'?");
  const CliRun run = folder.pac("render rom -o a.png");
  CHECK(run.code == 1);
  CHECK(contains(run.err, "did you mean 'room'?"));
}

TEST_CASE("values outside their range are refused with the range named") {
  const CliFolder folder;
  check_usage_error(folder.pac("jpeg encode a.png -o a.jpg -q 101"), "0.01..100");
  check_usage_error(folder.pac("jpeg encode a.png -o a.jpg -q nan"), "0.01..100");
  check_usage_error(folder.pac("render room -o a.png --width 0"), "1..32768");
  check_usage_error(folder.pac("render room -o a.png --width 12x"), "whole number");
  check_usage_error(folder.pac("geom encode a.obj -o a.pgc --position-bits 17"), "1..16");
  check_usage_error(folder.pac("render room -o a.png --samples 3"), "1, 4, 16, 64");
}

TEST_CASE("wrong usage is exit code 2 and says what is missing or too much") {
  const CliFolder folder;
  check_usage_error(folder.pac(""), "usage: pac COMMAND");
  check_usage_error(folder.pac("jpeg"), "jpeg encode");
  check_usage_error(folder.pac("render"), "missing SCENE");
  check_usage_error(folder.pac("render room"), "missing -o");
  check_usage_error(folder.pac("jpeg encode a.png"), "missing -o");
  check_usage_error(folder.pac("scenes extra"), "unexpected argument 'extra'");
  check_usage_error(folder.pac("render room -o"), "needs a value");
  check_usage_error(folder.pac("render room --width --height 3 -o a.png"), "--width needs a value");
  check_usage_error(folder.pac("render room -o a.gif"), ".png");
  check_usage_error(folder.pac("scenes --quiet=yes"), "takes no value");
  check_usage_error(folder.pac("jpeg encode a.png -o - --json"), "both want stdout");
  CHECK(folder.files().empty());
}

TEST_CASE("--json prints one JSON object and nothing else, for every command that answers") {
  const CliFolder folder;
  CHECK(json(folder.pac("isa --json")).contains("isa"));
  CHECK(json(folder.pac("scenes --json")).at("scenes[0].name") != "");
  const auto render = json(folder.pac(std::string(kSmall) + "--json -o a.png"));
  CHECK(number(render, "width") == 64);
  CHECK(number(render, "triangles") > 0);
  CHECK(render.contains("ms"));
  CHECK(render.at("hash").size() == 16);
  for (const char* change : {"--filter nearest ", "--fog 5 "})
    CHECK(json(folder.pac(std::string(kSmall) + change + "--json -o b.png")).at("hash") != render.at("hash"));
  const auto encoded = json(folder.pac("jpeg encode a.png -q 40 -o a.jpg --json"));
  CHECK(number(encoded, "bytes") == static_cast<double>(folder.read("a.jpg").size()));
  const auto info = json(folder.pac("jpeg info a.jpg --json"));
  CHECK(number(info, "height") == 48);
  CHECK(info.at("markers[0].name") == "SOI");
  for (const char* key : {"icc_profile_bytes", "exif_bytes", "xmp_bytes"}) CHECK(number(info, key) == 0);
  const std::string profiled = PAC_SOURCE_DIR "/tests/fuzz/corpus/jpeg_decode/icc.jpg";
  CHECK(number(json(folder.pac("jpeg info " + profiled + " --json")), "icc_profile_bytes") == 300);
  CHECK(number(json(folder.pac("jpeg decode a.jpg -o b.png --json")), "width") == 64);
  const auto metrics = json(folder.pac("metrics a.png b.png --json --map map.png"));
  CHECK(number(metrics, "rms") > 0);
  CHECK(number(metrics, "ssim") < 1);
  CHECK(number(metrics, "ssimulacra2") < 100);
  CHECK(number(metrics, "flip") > 0);
  CHECK(number(metrics, "psnr_hvs_m_db") > number(metrics, "psnr_hvs_db"));
  CHECK(folder.exists("map.png"));
  CHECK(json(folder.pac("metrics a.png a.png --json")).at("psnr_rgb_db") == "null");
}

TEST_CASE("isa lists every kernel") {
  const CliFolder folder;
  const auto isa = json(folder.pac("isa --json"));
  size_t n_listed = 0;
  while (isa.contains("kernels[" + std::to_string(n_listed) + "].name")) ++n_listed;
  const size_t n_kernels = (sizeof(pac::BlockKernels) + sizeof(pac::FrontKernels) + sizeof(pac::MotionKernels) +
                            sizeof(pac::PixelKernels) + sizeof(pac::TileKernels) + sizeof(pac::WarpKernels)) /
                           sizeof(void*);
  CHECK(n_listed == n_kernels);
}

TEST_CASE("bad data is exit code 1, named with file and byte, and leaves no file behind") {
  const CliFolder folder;
  REQUIRE(folder.pac(std::string(kSmall) + "-o a.png").code == 0);
  folder.write("cut.png", folder.read("a.png").substr(0, 60));
  folder.write("noise.jpg", "\xFF\xD8not a jpeg");
  folder.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 zero\nf 1 2 3\n");
  folder.write("bad.pgc", "PGCxxxxxxxxxxxxx");
  const auto before = folder.files();
  for (const char* arguments :
       {"jpeg encode cut.png -o out.jpg", "jpeg decode noise.jpg -o out.png", "jpeg info noise.jpg",
        "render bad.obj -o out.png", "compare bad.obj -o out", "geom encode bad.obj -o out.pgc",
        "geom decode bad.pgc -o out.ply", "geom info bad.pgc", "metrics a.png cut.png --map out.png"}) {
    CAPTURE(arguments);
    const CliRun run = folder.pac(arguments);
    CAPTURE(run.err);
    CHECK(run.code == 1);
    CHECK(run.out == "");
    CHECK(run.err.starts_with("pac: "));
    CHECK(contains(run.err, " (at byte "));
    CHECK(run.err.find('\n') == run.err.size() - 1);
  }
  CHECK(contains(folder.pac("render bad.obj -o out.png").err, "pac: bad.obj: malformed number (at byte 16)"));
  const CliRun missing = folder.pac("jpeg info nowhere.jpg");
  CHECK(missing.code == 1);
  CHECK(missing.err == "pac: nowhere.jpg: no such file\n");
  CHECK(folder.files() == before);
}

TEST_CASE("an output that cannot be written is exit code 1") {
  const CliFolder folder;
  const CliRun run = folder.pac(std::string(kSmall) + "-o no/such/folder/a.png");
  CHECK(run.code == 1);
  CHECK(contains(run.err, "cannot write"));
  CHECK(folder.files().empty());
}

TEST_CASE("files and pipes give the same bytes") {
  const CliFolder folder;
  REQUIRE(folder.pac(std::string(kSmall) + "-o a.png").code == 0);
  REQUIRE(folder.pac("jpeg encode a.png -q 30 -o a.jpg").code == 0);
  REQUIRE(folder.pac("jpeg decode a.jpg -o a.ppm").code == 0);
  const CliRun run =
      folder.shell(std::string("$PAC ") + kSmall + "-o - --quiet | $PAC jpeg encode - -q30 -o - --quiet | " +
                   "tee piped.jpg | $PAC jpeg decode - -o piped.ppm --quiet");
  CHECK(run.code == 0);
  CHECK(run.err == "");
  CHECK(folder.read("piped.jpg") == folder.read("a.jpg"));
  CHECK(folder.read("piped.ppm") == folder.read("a.ppm"));
}

TEST_CASE("messages and progress stay off stdout and away with --quiet") {
  const CliFolder folder;
  const CliRun loud = folder.pac(std::string(kSmall) + "-o a.png");
  CHECK(loud.out == "");
  CHECK(contains(loud.err, "64 x 48"));
  CHECK(!contains(loud.err, "\r"));
  CHECK(folder.pac(std::string(kSmall) + "-o a.png --quiet").err == "");
}

TEST_CASE("pixels do not depend on instruction set or threads") {
  const CliFolder folder;
  const std::string render = std::string(kSmall) + "--json";
  const std::string hash = json(folder.pac(render)).at("hash");
  CHECK(json(folder.pac(render + " --isa scalar")).at("hash") == hash);
  CHECK(json(folder.pac(render + " --threads 1")).at("hash") == hash);
  CHECK(json(folder.pac(render + " --threads 3", "PAC_ISA=scalar ")).at("hash") == hash);
  check_usage_error(folder.pac(render, "PAC_ISA=mmx "), "PAC_ISA: 'mmx' is not one of");
  CHECK(json(folder.pac("isa --json", "PAC_ISA=scalar ")).at("isa") == "scalar");
}

TEST_CASE("render's options change the picture; depth and ids come as files") {
  const CliFolder folder;
  const std::string letter = "render letter --width 64 --height 64 --json ";
  const auto hash = [&](const std::string& options) { return json(folder.pac(letter + options)).at("hash"); };
  const std::string high = hash("");
  for (const char* options :
       {"--quality low", "--texture off", "--shading flat", "--samples 1", "--frame 10", "--lighting full"}) {
    CAPTURE(options);
    CHECK(hash(options) != high);
  }
  CHECK(hash("--quality high --texture on") == high);
  CHECK(hash("--depth d.pfm --id id.png -o c.png") == high);
  CHECK(folder.read("d.pfm").starts_with("Pf\n64 64\n-1"));
  CHECK(folder.read("id.png").substr(1, 3) == "PNG");
  CHECK(folder.pac(letter + "--tessellation coarse").code == 1);
  CHECK(hash("--lighting local") == high);
}

TEST_CASE("jpeg encode keeps to a size, takes tables from a file, and its presets differ") {
  const CliFolder folder;
  REQUIRE(folder.pac("render letter --width 128 --height 128 --samples 4 -o a.png").code == 0);
  const auto sized = json(folder.pac("jpeg encode a.png --target-bytes 2500 -o s.jpg --json"));
  CHECK(number(sized, "bytes") <= 2500);
  CHECK(number(sized, "bytes") > 2000);
  const CliRun small = folder.pac("jpeg encode a.png --target-bytes 100 -o none.jpg");
  CHECK(small.code == 1);
  CHECK(contains(small.err, "does not fit 100 bytes"));
  CHECK(!folder.exists("none.jpg"));

  const auto bytes = [&](const std::string& options) {
    return number(json(folder.pac("jpeg encode a.png -q 50 -o b.jpg --json " + options)), "bytes");
  };
  CHECK(bytes("--effort fast") > bytes("--effort default"));
  CHECK(bytes("--effort best") < bytes("--effort default"));
  CHECK(bytes("--huffman standard --tables annex-k") > bytes("--huffman optimal --tables annex-k"));
  CHECK(bytes("--huffman difference --tables annex-k") > bytes("--huffman optimal --tables annex-k"));
  CHECK(bytes("--subsampling 444") > bytes("--subsampling gray"));
  CHECK(bytes("--restart 4") > bytes(""));

  std::string table = "# all alike\n";
  for (int i = 0; i < 64; ++i) table += "17 ";
  folder.write("flat.txt", table);
  REQUIRE(folder.pac("jpeg encode a.png --tables flat.txt -o flat.jpg").code == 0);
  CHECK(json(folder.pac("jpeg info flat.jpg --json")).at("quant_tables[0][63]") == "17");
  folder.write("short.txt", "1 2 3");
  CHECK(contains(folder.pac("jpeg encode a.png --tables short.txt -o n.jpg").err, "neither 64 nor 128"));
  folder.write("wrong.txt", "1 2 300");
  CHECK(contains(folder.pac("jpeg encode a.png --tables wrong.txt -o n.jpg").err, "1..255 (at byte 4)"));
}

TEST_CASE("a damaged JPEG file is refused, or kept as far as it goes with --lenient") {
  const CliFolder folder;
  REQUIRE(folder.pac("render letter --width 128 --height 128 --samples 1 -o a.png").code == 0);
  REQUIRE(folder.pac("jpeg encode a.png -q 80 -o a.jpg").code == 0);
  const std::string whole = folder.read("a.jpg");
  folder.write("cut.jpg", whole.substr(0, whole.size() * 2 / 3));
  CHECK(folder.pac("jpeg decode cut.jpg -o strict.png").code == 1);
  CHECK(!folder.exists("strict.png"));
  const CliRun lenient = folder.pac("jpeg decode cut.jpg --lenient -o lenient.png");
  CHECK(lenient.code == 1);
  CHECK(contains(lenient.err, "(at byte "));
  CHECK(folder.exists("lenient.png"));
  CHECK(folder.pac("jpeg decode a.jpg --lenient -o sound.png").code == 0);
}

TEST_CASE("jpeg decode scales and crops, transcode keeps the picture, encode takes factors and metadata") {
  const CliFolder folder;
  REQUIRE(folder.pac("render letter --width 100 --height 60 --samples 1 -o a.png").code == 0);
  REQUIRE(folder.pac("jpeg encode a.png --sampling 4x1,1x1,1x1 --comment hello --dpi 300 -o a.jpg").code == 0);
  const auto info = json(folder.pac("jpeg info a.jpg --json"));
  CHECK(info.at("components[0].horizontal_sampling") == "4");
  CHECK(info.at("density_x") == "300");
  const auto quarter = json(folder.pac("jpeg decode a.jpg --scale 1/4 --crop 10x8+3+2 -o b.png --json"));
  CHECK(number(quarter, "width") == 10);
  CHECK(number(quarter, "height") == 8);
  CHECK(folder.pac("jpeg decode a.jpg --crop 10x8+95+2 -o c.png").code == 1);
  check_usage_error(folder.pac("jpeg decode a.jpg --crop 10x8 -o c.png"), "--crop is WxH+X+Y");
  check_usage_error(folder.pac("jpeg encode a.png --sampling 4x4,1x1,1x1 -o n.jpg"), "at most 10 blocks");
  CHECK(contains(folder.pac("jpeg decode a.jpg --icc p.icc -o c.png").err, "no whole color profile"));

  REQUIRE(folder.pac("jpeg transcode a.jpg --restart 3 -o t.jpg").code == 0);
  CHECK(contains(folder.read("t.jpg"), "hello"));
  REQUIRE(folder.pac("jpeg transcode a.jpg --drop-metadata -o d.jpg").code == 0);
  CHECK(!contains(folder.read("d.jpg"), "hello"));
  REQUIRE(folder.pac("jpeg decode a.jpg -o a.ppm").code == 0);
  REQUIRE(folder.pac("jpeg decode t.jpg -o t.ppm").code == 0);
  CHECK(folder.read("a.ppm") == folder.read("t.ppm"));
  REQUIRE(folder.pac("jpeg encode a.png --metadata-from a.jpg -o m.jpg").code == 0);
  CHECK(contains(folder.read("m.jpg"), "hello"));
}

TEST_CASE("meshes go through the geometry codec and come back as PLY") {
  const CliFolder folder;
  const auto coded = json(folder.pac("geom encode cubes -o cubes.pgc --json"));
  CHECK(number(coded, "bytes") == static_cast<double>(folder.read("cubes.pgc").size()));
  CHECK(number(coded, "parts.connectivity") > 0);
  CHECK(number(coded, "bits_per_triangle") > 0);
  const auto info = json(folder.pac("geom info cubes.pgc --json"));
  CHECK(number(info, "polygons") == number(coded, "polygons"));
  REQUIRE(folder.pac("geom decode cubes.pgc -o cubes.ply").code == 0);
  CHECK(folder.read("cubes.ply").starts_with("ply\n"));
  const auto again = json(folder.pac("geom encode cubes.ply --position-bits 8 --keep-order -o small.pgc --json"));
  CHECK(number(again, "polygons") == number(coded, "polygons"));
  CHECK(number(again, "parts.order") >= 0);
  CHECK(json(folder.pac("render cubes.ply --width 32 --height 32 --json")).contains("hash"));
}

TEST_CASE("a model of one's own renders with its textures; a missing one is a warning") {
  const CliFolder folder;
  folder.write("m.obj",
               "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
               "usemtl a\nf 1/1 2/2 3/3 4/4\n");
  folder.write("m.mtl", "newmtl a\nKd 1 1 1\nmap_Kd tex/t.jpg\n");
  const CliRun missing = folder.pac("render m.obj --width 32 --height 32 -o a.png");
  CHECK(missing.code == 0);
  CHECK(contains(missing.err, "pac: m.obj: warning: "));
  CHECK(contains(missing.err, "t.jpg"));
  CHECK(folder.pac("render m.obj --width 32 --height 32 -o a.png --quiet").err == "");
  REQUIRE(
      folder
          .shell(std::string("mkdir tex && $PAC ") + kSmall + "-o t.png && $PAC jpeg encode t.png -o tex/t.jpg --quiet")
          .code == 0);
  const CliRun found = folder.pac("render m.obj --width 32 --height 32 -o b.png");
  CHECK(found.code == 0);
  CHECK(!contains(found.err, "warning"));
  CHECK(folder.read("a.png") != folder.read("b.png"));
}

TEST_CASE("animate shows a model of one's own in every frame, and from another side in the next") {
  const CliFolder folder;
  folder.write("m.obj", "v 499 -1 0\nv 501 -1 0\nv 501 1 1\nv 499 1 0\nf 1 2 3 4\n");
  REQUIRE(folder.pac("animate m.obj --codec mjpeg --frames 2 --width 64 --height 64 -o out").code == 0);
  const std::string sequence = folder.read("out/H.y4m");
  constexpr size_t kLuma = 64 * 64, kFrame = kLuma * 3 / 2;
  REQUIRE(sequence.size() > 2 * kFrame);
  const std::string second = sequence.substr(sequence.size() - kFrame, kLuma);
  const std::string first = sequence.substr(sequence.size() - 2 * kFrame - 6, kLuma);  // "FRAME\n" between them
  CHECK(first.find_first_not_of(first[0]) != std::string::npos);
  CHECK(second.find_first_not_of(second[0]) != std::string::npos);
  CHECK(first != second);
}

TEST_CASE("animate moves what can move: a glTF file's nodes unasked, parts of the cubes when asked") {
  const CliFolder folder;
  // A triangle that slides to the right for two seconds, and one that stands: key times 0 and 2, places, corners.
  folder.write(
      "m.gltf",
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0},{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},)"
      R"({"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[2]},)"
      R"({"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}],)"
      R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":8},)"
      R"({"buffer":0,"byteOffset":44,"byteLength":24}],)"
      R"("buffers":[{"byteLength":68,"uri":"data:application/octet-stream;base64,)"
      "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAEAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAA="
      R"("}],"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],)"
      R"("samplers":[{"input":1,"output":2}]}]})");
  const std::string small = " --codec mpeg1 --frames 2 --fps 1 --width 64 --height 64 --samples 1 --json ";
  const CliRun run = folder.pac("animate m.gltf" + small + "-o moving");
  if (run.code != 0 && contains(run.err, "built without glTF")) return;
  CHECK(json(run).at("objects") == "moving");
  CHECK(json(folder.pac("animate m.gltf --objects still" + small + "-o still")).at("objects") == "still");
  CHECK(folder.read("moving/H.y4m") != folder.read("still/H.y4m"));
  CHECK(folder.read("moving/H.y4m").substr(0, 64 * 64) == folder.read("still/H.y4m").substr(0, 64 * 64));

  CHECK(json(folder.pac("animate cubes" + small + "-o cubes")).at("objects") == "still");
  CHECK(json(folder.pac("animate cubes --objects moving" + small + "-o bobbing")).at("objects") == "moving");
  CHECK(folder.read("cubes/H.y4m") != folder.read("bobbing/H.y4m"));
  check_usage_error(folder.pac("animate letter --objects moving --frames 1"), "nothing in this scene can move");
}

TEST_CASE("compare matches both arms' bytes and writes a page of its own") {
  const CliFolder folder;
  const std::string compare = "compare letter-texture --width 96 --height 96 --samples 1 --json ";
  const auto still = json(folder.pac(compare + "-o page"));
  CHECK(number(still, "image_based.quality") == 15);
  const double image = number(still, "image_based.bytes"), polygon = number(still, "polygon_assisted.bytes");
  CHECK(polygon == doctest::Approx(image).epsilon(0.02));
  for (const char* key : {"polygon_assisted.rms", "polygon_assisted.ssim", "polygon_assisted.quality_division_undone",
                          "entropy_bits.high.luma", "image_based.compression_ratio"})
    CHECK(still.contains(key));
  CHECK(contains(folder.read("page/index.html"), "</html>"));
  CHECK(folder.exists("page/still-polygon.png"));
  const std::string sent = compare + "--bytes 1500 --tables adapted --huffman optimal --model transmitted";
  const auto sized = json(folder.pac(sent));
  CHECK(number(sized, "image_based.bytes") == doctest::Approx(1500).epsilon(0.02));
  CHECK(number(sized, "polygon_assisted.bytes") == doctest::Approx(1500).epsilon(0.02));
  CHECK(number(sized, "polygon_assisted.model_bytes") > 0);
  CHECK(sized.contains("divisions[1].rms"));
  const auto at_16_bits = json(folder.pac(sent + " --position-bits 16"));
  CHECK(number(at_16_bits, "model.position_bits") == 16);
  CHECK(number(sized, "polygon_assisted.rms") <= number(at_16_bits, "polygon_assisted.rms"));
  check_usage_error(folder.pac(compare + "--position-bits 12"), "--model transmitted");
  CHECK(json(folder.pac(compare + "--split antialiasing")).at("split") == "antialiasing");
  CHECK(folder.pac(compare + "--split lightning").code == 1);
  check_usage_error(folder.pac("compare letter --bytes 1500 -q 3"), "leave --quality out");
  check_usage_error(folder.pac("compare letter --masking ssim"), "--tables adapted");
}

TEST_CASE("metrics compares sequences frame by frame") {
  const CliFolder folder;
  const auto clip = [](int n_frames, char luma) {
    std::string file = "YUV4MPEG2 W16 H16 F20:1 C420jpeg\n";
    for (int i = 0; i < n_frames; ++i)
      file += "FRAME\n" + std::string(256, static_cast<char>(luma + i)) + std::string(128, '\x80');
    return file;
  };
  folder.write("a.y4m", clip(3, 40));
  folder.write("b.y4m", clip(3, 44));
  folder.write("short.y4m", clip(2, 40));
  const auto scores = json(folder.pac("metrics a.y4m b.y4m --json"));
  CHECK(number(scores, "frames") == 3);
  CHECK(number(scores, "rms_luma.mean") == doctest::Approx(4));
  CHECK(number(scores, "rms_luma.worst_5_percent") == doctest::Approx(4));
  CHECK(number(scores, "flicker.mean") == 0);  // 4 levels too bright in every frame
  CHECK(number(scores, "ssimulacra2.mean") < 100);
  CHECK(number(scores, "flip.worst_5_percent") >= number(scores, "flip.mean"));
  CHECK(number(scores, "psnr_hvs_m_db.mean") > 20);
  CHECK(number(scores, "ms_ssim.mean") < 1);
  const CliRun shorter = folder.pac("metrics a.y4m short.y4m");
  CHECK(shorter.code == 1);
  CHECK(contains(shorter.err, "fewer frames"));
}

TEST_CASE("pictures of different sizes are not compared") {
  const CliFolder folder;
  REQUIRE(folder.pac(std::string(kSmall) + "-o a.png").code == 0);
  REQUIRE(folder.pac("render cubes --width 32 --height 48 --samples 1 -o b.png").code == 0);
  const CliRun run = folder.pac("metrics a.png b.png");
  CHECK(run.code == 1);
  CHECK(contains(run.err, "is 32x48 pixels, but a.png is 64x48"));
}
