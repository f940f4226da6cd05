#include "tests/support/reference_decoder.h"

#include <doctest/doctest.h>

#include <cstdio>

namespace pac::test {

std::string summary(const geomcodec::QuantizedMesh& mesh) {
  Fnv fnv;
  for (const auto& vertex : mesh.vertices) {
    for (const uint16_t coordinate : vertex.position) fnv.add(coordinate);
    for (const uint8_t channel : vertex.color) fnv.add(channel);
    for (const uint16_t component : vertex.normal) fnv.add(component);
    for (const uint16_t component : vertex.texcoord) fnv.add(component);
  }
  for (const Face& face : mesh.faces) {
    for (uint32_t k = 0; k < face.count; ++k) fnv.add(mesh.indices[face.first + k]);
    fnv.add(face.material);
  }
  for (const uint16_t value : mesh.face_values) fnv.add(value);
  char text[64];
  std::snprintf(text, sizeof text, "%zu %zu %016llx\n", mesh.vertices.size(), mesh.faces.size(),
                static_cast<unsigned long long>(fnv.hash()));
  return text;
}

void require_decoded(const std::string& script, const std::string& arguments, const std::string& expected) {
  const std::string command = "python3 -B " PAC_SOURCE_DIR "/tests/" + script + arguments;
  std::FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string output;
  char line[256];
  while (std::fgets(line, sizeof line, pipe) != nullptr) output += line;
  REQUIRE(pclose(pipe) == 0);
  REQUIRE(output == expected);
}

}  // namespace pac::test
