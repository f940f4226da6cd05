// Sweeps: the list of jobs, shards, CSV there and back, gains with intervals, the page.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>

#include "sim/report_sweep.h"
#include "sim/sweep.h"
#include "sim/sweep_gain.h"
#include "tests/support/json_check.h"
#include "tests/support/run_cli.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

sim::SweepPlan plan_of(std::vector<sim::SweepScene> scenes) {
  sim::SweepPlan plan;
  plan.scenes = std::move(scenes);
  plan.codecs = {sim::SweepCodec::jpeg, sim::SweepCodec::mjpeg, sim::SweepCodec::mpeg1};
  plan.qualities = {10, 40};
  plan.quantizers = {4, 12, 31};
  plan.width = 48;
  plan.height = 33;
  plan.samples = 1;
  plan.frames = 2;
  return plan;
}

sim::SweepTable table_of(const sim::SweepPlan& plan, sim::SweepShard shard, int threads = 2) {
  sim::SweepOptions options;
  options.shard = shard;
  options.threads = threads;
  const auto run = sim::run_sweep(plan, options);
  REQUIRE(run.ok());
  CHECK(run->times.size() == run->table.points.size());
  return run->table;
}

// A curve whose bytes double with every step of score, on top of `first` bytes.
void add_curve(sim::SweepTable& table, const std::string& scene, sim::SweepArm arm, uint64_t first,
               double flip_offset) {
  for (int step = 0; step < 4; ++step) {
    sim::SweepPoint point;
    point.job = table.n_jobs++;
    point.scene = scene;
    point.split = "texture";
    point.codec = sim::SweepCodec::jpeg;
    point.arm = arm;
    point.setting = 10 + step;
    point.width = point.height = 64;
    point.frames = 1;
    point.frames_per_second = 20;
    point.bytes = first << step;
    const double s = step;
    point.scores = {{{20 * s, 20 * s},
                     {0.5 - 0.1 * s + flip_offset, 0.5 - 0.1 * s + flip_offset},
                     {20 + s, 20 + s},
                     {20 + s, 20 + s},
                     {0.5 + 0.1 * s, 0.5 + 0.1 * s}}};
    table.points.push_back(point);
  }
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("shards of any count together do every job exactly once, in shares that differ by one at most") {
  const sim::SweepPlan plan = plan_of({{"a", {"texture", "shading"}, nullptr, {}}, {"b", {"texture"}, nullptr, {}}});
  const auto jobs = sim::sweep_jobs(plan);
  CHECK(jobs.size() == 3 * (2 * 2 + 2 * 2 + 4 * 3));
  for (size_t i = 0; i < jobs.size(); ++i) CHECK(jobs[i].number == i);
  for (const uint64_t count : {1u, 2u, 3u, 7u, 60u, 100u}) {
    std::map<uint64_t, int> times_done;
    size_t least = jobs.size(), most = 0;
    for (uint64_t number = 1; number <= count; ++number) {
      const auto mine = sim::jobs_of_shard(jobs, {number, count});
      least = std::min(least, mine.size());
      most = std::max(most, mine.size());
      for (const sim::SweepJob& job : mine) ++times_done[job.number];
    }
    CHECK(most - least <= 1);
    CHECK(times_done.size() == jobs.size());
    for (const auto& [job, n] : times_done) CHECK(n == 1);
  }
}

TEST_CASE("joined shards are the whole sweep, byte for byte, in tables, plots and page, on any number of threads") {
  const sim::SceneSet set = test::small_scene(false);
  const sim::SweepPlan plan = plan_of({{"small", {"texture"}, &set, test::small_camera}});
  const sim::SweepTable whole = table_of(plan, {1, 1}, 1);
  sim::SweepTable joined;
  for (const uint64_t number : {3u, 1u, 2u}) {
    const auto part = sim::read_sweep_csv(sim::sweep_csv(table_of(plan, {number, 3}, 2)));
    REQUIRE(part.ok());
    REQUIRE(sim::join_sweep(joined, *part).ok());
  }
  CHECK(sim::missing_jobs(joined).empty());
  CHECK(sim::sweep_csv(joined) == sim::sweep_csv(whole));
  const auto page = [](const sim::SweepTable& table) {
    return sim::sweep_html(table, sim::sweep_gains(table), sim::sweep_plots(table));
  };
  CHECK(page(joined) == page(whole));
  CHECK(sim::sweep_gains_csv(sim::sweep_gains(joined)) == sim::sweep_gains_csv(sim::sweep_gains(whole)));
  const auto same_files = [&](size_t i) {
    return sim::plot_svg_file(sim::sweep_plots(joined)[0].plots[i]) ==
           sim::plot_svg_file(sim::sweep_plots(whole)[0].plots[i]);
  };
  for (size_t i = 0; i < 9; ++i) CHECK(same_files(i));
}

TEST_CASE("finer settings take more bytes and look better; every arm of every codec has its curve") {
  const sim::SceneSet set = test::small_scene(false);
  const sim::SweepTable table = table_of(plan_of({{"small", {"texture"}, &set, test::small_camera}}), {1, 1});
  int n_curves = 0;
  for (const auto codec : {sim::SweepCodec::jpeg, sim::SweepCodec::mjpeg, sim::SweepCodec::mpeg1})
    for (const auto arm : {sim::SweepArm::image, sim::SweepArm::polygons, sim::SweepArm::none, sim::SweepArm::block,
                           sim::SweepArm::model}) {
      const auto curve = sim::curve_of(table, "small", "texture", codec, arm);
      if (curve.empty()) continue;
      ++n_curves;
      CHECK(curve.front().bytes < curve.back().bytes);
      CHECK(curve.front().scores[3].mean < curve.back().scores[3].mean);
      CHECK(curve.front().frames == (codec == sim::SweepCodec::jpeg ? 1 : 2));
      CHECK((curve.front().resident_model_bytes == 0) == (arm == sim::SweepArm::image));
    }
  CHECK(n_curves == 8);
  CHECK(sim::sweep_gains(table).scenes.size() == 6);
}

TEST_CASE("a sweep's CSV names its columns and reads back exactly, whatever the scene is called") {
  sim::SweepTable table;
  table.plan = "'a,\"b\".obj' --splits texture";
  add_curve(table, "a,\"b\"\n.obj", sim::SweepArm::image, 1000, 0.1 + 0.2);
  const std::string csv = sim::sweep_csv(table);
  CHECK(
      csv.starts_with("job,jobs,scene,split,codec,arm,setting,width,height,frames,frames_per_second,bytes,"
                      "resident_model_bytes,ssimulacra2,ssimulacra2_worst_5_percent,flip,flip_worst_5_percent,"
                      "psnr_hvs_m_db,psnr_hvs_m_db_worst_5_percent,psnr_rgb_db,psnr_rgb_db_worst_5_percent,ssim,"
                      "ssim_worst_5_percent,plan\n"));
  const auto back = sim::read_sweep_csv(csv);
  REQUIRE(back.ok());
  CHECK(back->plan == table.plan);
  CHECK(back->points == table.points);
  CHECK(sim::sweep_csv(*back) == csv);
}

TEST_CASE("every strict prefix of a CSV file is refused, or ends between two lines") {
  sim::SweepTable table;
  table.plan = "a, b";
  add_curve(table, "a", sim::SweepArm::image, 1000, 0);
  const std::string csv = sim::sweep_csv(table);
  for (size_t n = 0; n < csv.size(); ++n) {
    const bool whole_lines = n > 0 && csv[n - 1] == '\n';
    CHECK(sim::read_sweep_csv(csv.substr(0, n)).ok() == whole_lines);
  }
  for (const auto& change : {std::pair("jpeg", "gif"), std::pair(",64,64", ",0,64"), std::pair(",1000,", ",1e3,"),
                             std::pair(",image,", ",imago,"), std::pair("20,20", "nan,20"), std::pair("0,4,a", "9,4,a"),
                             std::pair("0,4,a", "3,4,a")}) {
    std::string bad = csv;
    const std::string from = change.first;
    CAPTURE(from);
    REQUIRE(contains(bad, from));
    bad.replace(bad.find(from, bad.find('\n')), from.size(), change.second);
    CHECK(!sim::read_sweep_csv(bad).ok());
  }
}

TEST_CASE("parts of another sweep and jobs done twice are refused, and leave the table alone") {
  sim::SweepTable table, part, other;
  table.plan = part.plan = "a";
  other.plan = "b";
  add_curve(table, "a", sim::SweepArm::image, 1000, 0);
  add_curve(other, "a", sim::SweepArm::image, 1000, 0);
  part.n_jobs = 4;
  part.points = {table.points[2]};
  CHECK(!sim::join_sweep(table, part).ok());
  CHECK(!sim::join_sweep(table, other).ok());
  CHECK(table.points.size() == 4);
  table.points.erase(table.points.begin() + 1, table.points.begin() + 3);
  CHECK(sim::missing_jobs(table) == std::vector<uint64_t>{1, 2});
  CHECK(sim::join_sweep(table, part).ok());
  CHECK(sim::missing_jobs(table) == std::vector<uint64_t>{1});
}

TEST_CASE("half the bytes at every score is -50 %, and the metrics that disagree are said to") {
  sim::SweepTable table;
  add_curve(table, "agrees", sim::SweepArm::image, 2000, 0);
  add_curve(table, "agrees", sim::SweepArm::polygons, 1000, 0);
  add_curve(table, "disagrees", sim::SweepArm::image, 2000, 0);
  add_curve(table, "disagrees", sim::SweepArm::polygons, 1000, 0.15);  // FLIP is worse at equal bytes
  const sim::SweepGains gains = sim::sweep_gains(table);
  REQUIRE(gains.scenes.size() == 2);
  REQUIRE(gains.scenes[0].mean[0].has_value());
  CHECK(*gains.scenes[0].mean[0] == doctest::Approx(-50));
  CHECK(*gains.scenes[0].worst[1] == doctest::Approx(-50));
  CHECK(gains.scenes[0].verdict == Verdict::second_better);
  CHECK(gains.scenes[1].verdict == Verdict::disagree);
  REQUIRE(gains.splits.size() == 1);
  CHECK(gains.splits[0].n_better == 1);
  CHECK(gains.splits[0].n_disagree == 1);
  CHECK(contains(sim::sweep_html(table, gains, sim::sweep_plots(table)), "metrics disagree in 1"));
}

TEST_CASE("the interval holds the geometric mean, shrinks with more scenes and is one point for one scene") {
  const double one[] = {-30};
  CHECK(sim::bootstrap_interval(one).low == doctest::Approx(-30));
  CHECK(sim::bootstrap_interval(one).high == doctest::Approx(-30));
  const double two[] = {-75, 0};  // a quarter and the same: half in the mean
  const auto few = sim::bootstrap_interval(two);
  CHECK(few.percent == doctest::Approx(-50));
  CHECK(few.low == doctest::Approx(-75));
  CHECK(few.high == doctest::Approx(0));
  std::vector<double> many;
  for (int i = 0; i < 40; ++i) many.push_back(two[i % 2]);
  const auto narrow = sim::bootstrap_interval(many);
  CHECK(narrow.percent == doctest::Approx(-50));
  CHECK(narrow.high - narrow.low < 0.5 * (few.high - few.low));
  // The normal approximation: ln 0.5 +- 1.96 * ln 2 / sqrt 40, that is -59.7 % and -38.0 %.
  CHECK(narrow.low == doctest::Approx(-59.7).epsilon(0.03));
  CHECK(narrow.high == doctest::Approx(-38.0).epsilon(0.06));
}

TEST_CASE("plans out of range are refused before anything is drawn") {
  const sim::SceneSet set = test::small_scene(false);
  const sim::SweepPlan good = plan_of({{"small", {"texture"}, &set, test::small_camera}});
  sim::SweepPlan plans[5] = {good, good, good, good, good};
  plans[0].qualities = {101};
  plans[1].quantizers = {0.5};
  plans[2].frames = 0;
  plans[3].width = 70000;
  plans[4].scenes[0].splits = {"nonsense"};
  for (const sim::SweepPlan& plan : plans) CHECK(!sim::run_sweep(plan).ok());
  sim::SweepOptions options;
  options.shard = {3, 2};
  CHECK(!sim::run_sweep(good, options).ok());
}

// ---- the command

namespace {
constexpr const char* kSmallSweep =
    "sweep letter --width 40 --height 32 --samples 1 --frames 2 --codecs jpeg,mpeg1 --qualities 20,60 "
    "--quantizers 8,31 --effort fast ";
}

TEST_CASE("pac sweep: shards in one folder, merged, give the files of the unsharded run") {
  const test::CliFolder folder;
  const auto whole = folder.pac(std::string(kSmallSweep) + "-o whole");
  CAPTURE(whole.err);
  REQUIRE(whole.code == 0);
  CHECK(contains(whole.out, "SSIMULACRA 2"));
  for (const char* shard : {"1/3", "2/3"})
    REQUIRE(folder.pac(std::string(kSmallSweep) + "-o parts --shard " + shard).code == 0);
  const auto early = folder.pac("sweep --merge parts -o early");
  CHECK(early.code == 1);
  CHECK(contains(early.err, "jobs are missing: 2, 5, 8, 11 of 12"));
  CHECK(!folder.exists("early"));
  REQUIRE(folder.pac(std::string(kSmallSweep) + "-o more --shard 3/3").code == 0);
  const auto merged = folder.pac("sweep --merge more parts -o merged");
  CAPTURE(merged.err);
  REQUIRE(merged.code == 0);
  CHECK(folder.shell("rm whole/times.csv merged/times.csv && diff -r whole merged").code == 0);
  const auto twice = folder.pac("sweep --merge parts merged -o twice");
  CHECK(twice.code == 1);
  CHECK(contains(twice.err, "some of its jobs are in another part"));
  const auto json = test::json_leaves(folder.pac("sweep --merge merged -o again --json").out);
  REQUIRE(json.has_value());
  CHECK(json->at("jobs") == "12");
  CHECK(json->at("gains[0].codec") == "jpeg");
}

TEST_CASE("pac sweep says what is wrong with its input") {
  const test::CliFolder folder;
  const auto fails = [&](const std::string& arguments, int code, const std::string& part) {
    CAPTURE(arguments);
    const auto run = folder.pac("sweep " + arguments);
    CAPTURE(run.err);
    CHECK(run.code == code);
    CHECK(run.out == "");
    CHECK(contains(run.err, part));
  };
  fails("", 2, "missing SCENE");
  fails("letter", 2, "missing -o");
  fails("letter letter -o a", 2, "'letter' is there twice");
  fails("letter -o a --shard 3/2", 2, "is not I/N with 1 <= I <= N");
  fails("letter -o a --shard 0/2", 2, "is not I/N");
  fails("letter -o a --codecs mpeg2", 2, "did you mean 'mpeg1'?");
  fails("letter -o a --codecs jpeg,jpeg", 2, "there twice");
  fails("letter -o a --splits textur", 2, "did you mean 'texture'?");
  fails("letter -o a --qualities 10,0", 2, "0.01..100");
  fails("letter -o a --quantizers 4,,8", 2, "'' is not a number");
  fails("lettr -o a", 1, "did you mean 'letter'?");
  fails("letter -o a --splits tessellation", 1, "can do none of the splits");
  fails("--merge nowhere -o a", 1, "pac: nowhere/sweep.csv: no such file");
  fails("--merge nowhere -o a --frames 3", 2, "leave out --frames");
  folder.shell("mkdir broken && printf 'job,jobs\\n' > broken/sweep.csv");
  fails("--merge broken -o a", 1, "this is no sweep's CSV file");
  CHECK(!folder.exists("a"));
}
