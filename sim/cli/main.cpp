// `pac`: finds the subcommand and runs it.
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "sim/cli/command.h"

namespace pac::cli {
namespace {

struct Command {
  const char* name;  // one or two words
  const char* summary;
  int (*run)(Args args);
};

constexpr Command kCommands[] = {
    {"demo", "the paper's experiments on the built-in scenes, as a page and Table I", run_demo},
    {"render", "draws one picture of a scene", run_render},
    {"compare", "one still, image-based and polygon-assisted at matched bytes", run_compare},
    {"animate", "a sequence, image-based and polygon-assisted at matched bytes", run_animate},
    {"sweep", "rate-distortion curves over scenes, splits, codecs and rates", run_sweep},
    {"jpeg encode", "writes a baseline JPEG file", run_jpeg_encode},
    {"jpeg decode", "writes a JPEG file's picture as PNG, PPM or PGM", run_jpeg_decode},
    {"jpeg transcode", "writes a JPEG file again as baseline, losslessly", run_jpeg_transcode},
    {"jpeg info", "markers, frame, tables, estimated quality, metadata", run_jpeg_info},
    {"mpeg1 encode", "codes a Y4M clip as MPEG-1 video", run_mpeg1_encode},
    {"mpeg1 decode", "writes MPEG-1 video as Y4M", run_mpeg1_decode},
    {"mpeg1 info", "what the headers of MPEG-1 video say", run_mpeg1_info},
    {"geom encode", "codes a polygon mesh", run_geom_encode},
    {"geom decode", "writes a coded mesh as PLY", run_geom_decode},
    {"geom info", "what a coded mesh's header says", run_geom_info},
    {"metrics", "how far a picture or sequence is from its reference", run_metrics},
    {"scenes", "the built-in scenes", run_scenes},
    {"isa", "which implementation each kernel uses, and which are built", run_isa},
};

bool is_group(std::string_view word) {
  for (const Command& command : kCommands)
    if (std::string_view(command.name).starts_with(std::string(word) + " ")) return true;
  return false;
}

// Commands that start with `group` (all where it is empty).
void print_commands(std::FILE* out, const std::string& group) {
  std::fprintf(out, "usage: pac %s%sCOMMAND [arguments]\n\n", group.c_str(), group.empty() ? "" : " ");
  for (const Command& command : kCommands)
    if (group.empty() || std::string_view(command.name).starts_with(group + " "))
      std::fprintf(out, "  %-16s %s\n", command.name, command.summary);
  std::fprintf(out, "\n'pac COMMAND --help' lists options with an example.\n");
}

int unknown_command(const std::string& name) {
  std::vector<std::string> names;
  for (const Command& command : kCommands) names.emplace_back(command.name);
  const std::string suggestion = nearest(name, names);
  std::fprintf(stderr, "pac: unknown command '%s'%s\n'pac --help' lists the commands\n", name.c_str(),
               suggestion.empty() ? "" : ("; did you mean '" + suggestion + "'?").c_str());
  return kBadUsage;
}

bool is_help(std::string_view word) {
  return word == "--help" || word == "-h" || word == "help";
}

int run(Args args) {
  if (args.empty()) {
    print_commands(stderr, "");
    return kBadUsage;
  }
  const std::string first = args[0];
  if (is_help(first)) {
    std::printf("pac: polygon-assisted compression of synthetic images [Levoy 1995]\n");
    print_commands(stdout, "");
    return kDone;
  }
  if (first == "--version") {
    std::printf("pac " PAC_VERSION "\n");
    return kDone;
  }
  const bool grouped = is_group(first);
  if (grouped && (args.size() < 2 || is_help(args[1]))) {
    print_commands(args.size() < 2 ? stderr : stdout, first);
    return args.size() < 2 ? kBadUsage : kDone;
  }
  const std::string name = grouped ? first + " " + args[1] : first;
  for (const Command& command : kCommands)
    if (name == command.name) return command.run(args.subspan(grouped ? 2 : 1));
  return unknown_command(name);
}

}  // namespace
}  // namespace pac::cli

int main(int argc, char** argv) {
  return pac::cli::run({argv + 1, static_cast<size_t>(argc > 0 ? argc - 1 : 0)});
}
