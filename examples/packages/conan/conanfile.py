# Conan 2: conan create build/packages/conan
from os.path import join

from conan import ConanFile
from conan.tools.files import copy


class Flexbeam(ConanFile):
    name = "flexbeam"
    version = "@VERSION@"
    description = "Flexible bodies in real time, a header-only C99 library"
    license = "MIT"
    package_type = "header-library"
    settings = "os"
    exports_sources = "flexbeam.h", "flexbeam_impl.h", "LICENSE"
    no_copy_source = True

    def package(self):
        copy(self, "*.h", self.source_folder, join(self.package_folder, "include"))
        copy(self, "LICENSE", self.source_folder, join(self.package_folder, "licenses"))

    def package_id(self):
        self.info.clear()

    def package_info(self):
        self.cpp_info.bindirs = []
        self.cpp_info.libdirs = []
        if self.settings.get_safe("os") != "Windows":
            self.cpp_info.system_libs = ["m"]
        self.cpp_info.set_property("cmake_file_name", "flexbeam")
        self.cpp_info.set_property("cmake_target_name", "flexbeam::flexbeam")
