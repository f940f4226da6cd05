#include "sim/cli/report_files.h"

#include <sys/stat.h>

#include <cerrno>
#include <vector>

#include "base/image_io.h"
#include "base/parallel.h"

namespace pac::cli {

int make_folder(const std::string& folder) {
  for (size_t slash = folder.find('/', 1);; slash = folder.find('/', slash + 1)) {
    const std::string part = folder.substr(0, slash);
    if (mkdir(part.c_str(), 0777) != 0 && errno != EEXIST) return data_error(part, "cannot make this folder");
    if (slash == std::string::npos) break;
  }
  struct stat info;
  if (stat(folder.c_str(), &info) != 0 || !S_ISDIR(info.st_mode)) return data_error(folder, "is not a folder");
  return kDone;
}

int write_report(const std::string& folder, const sim::IllustratedReport& page, const Options& options,
                 const char* name) {
  if (const int code = make_folder(folder); code != kDone) return code;
  std::vector<Bytes> files(page.images.size());
  parallel_for(options.threads, static_cast<int64_t>(files.size()), [&](int64_t i) {
    const auto index = static_cast<size_t>(i);
    if (!page.images[index].image.empty()) files[index] = encode_png(page.images[index].image);
  });
  for (size_t i = 0; i < files.size(); ++i)
    if (const int code = write_output(folder + "/" + page.images[i].file, files[i]); code != kDone) return code;
  return write_output(folder + "/" + name, sim::report_html(page.report));
}

}  // namespace pac::cli
