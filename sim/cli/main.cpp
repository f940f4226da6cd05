#include <cstdio>

int main() {
  std::fprintf(stderr, "usage: pac COMMAND\n");
  return 2;
}
