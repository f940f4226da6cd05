// `pac scenes`: what is built in.
#include "sim/scenes.h"

#include <cstdio>

#include "sim/cli/command.h"

namespace pac::cli {

int run_scenes(Args args) {
  Options options("scenes", "lists the built-in scenes", "pac scenes");
  if (const auto code = options.parse(args)) return *code;
  if (!options.json) {
    for (const sim::BuiltinScene& scene : sim::builtin_scenes()) std::printf("%-16s %s\n", scene.name, scene.summary);
    return kDone;
  }
  sim::JsonWriter json;
  json.begin_object();
  json.begin_array("scenes");
  for (const sim::BuiltinScene& scene : sim::builtin_scenes()) {
    json.begin_object();
    json.field("name", scene.name);
    json.field("summary", scene.summary);
    json.end_object();
  }
  json.end_array();
  json.end_object();
  return print_json(json);
}

}  // namespace pac::cli
