SUMMARY = "Calibrates a robot's cameras and LiDARs at the press of a button"
LICENSE = "Apache-2.0"
LIC_FILES_CHKSUM = "file://LICENSE;md5=3b83ef96387f14655fc854ddc3c6bd57"

# The tree that this recipe lies in; for a release set SRC_URI and SRCREV to yours.
inherit externalsrc cmake pkgconfig python3native systemd useradd
EXTERNALSRC = "${@os.path.abspath(os.path.join(os.path.dirname(d.getVar('FILE')), '../../../..'))}"
EXTERNALSRC_BUILD = "${WORKDIR}/build"

DEPENDS = "libeigen flatbuffers flatbuffers-native"

# The product of roomcald --help.
ROOMCAL_BOARD ??= "mobile_robot"

EXTRA_OECMAKE = "-DROOMCAL_HARDEN=ON -DROOMCAL_TOOLS=OFF -DROOMCAL_TESTS=OFF -DROOMCAL_BENCHMARKS=OFF"
PACKAGECONFIG ??= ""
PACKAGECONFIG[mjpeg] = "-DROOMCAL_MJPEG=ON,-DROOMCAL_MJPEG=OFF,libjpeg-turbo"
PACKAGECONFIG[libcamera] = "-DROOMCAL_LIBCAMERA=ON,-DROOMCAL_LIBCAMERA=OFF,libcamera"
PACKAGECONFIG[aravis] = "-DROOMCAL_ARAVIS=ON,-DROOMCAL_ARAVIS=OFF,aravis"

do_install:append() {
    sed -i 's/^ROOMCAL_BOARD=.*/ROOMCAL_BOARD=${ROOMCAL_BOARD}/' ${D}${sysconfdir}/default/roomcald
    if ${@bb.utils.contains('DISTRO_FEATURES', 'systemd', 'false', 'true', d)}; then
        install -D -m 0755 ${S}/board/service/roomcald.init ${D}${sysconfdir}/init.d/roomcald
    fi
}

SYSTEMD_SERVICE:${PN} = "roomcald.service"
USERADD_PACKAGES = "${PN}"
USERADD_PARAM:${PN} = "--system --home-dir /var/lib/roomcal --shell /sbin/nologin --groups video,input,dialout roomcal"
CONFFILES:${PN} = "${sysconfdir}/default/roomcald ${sysconfdir}/roomcal/README"
FILES:${PN} += "${prefix}/lib ${datadir}/roomcal"
RRECOMMENDS:${PN} = "kernel-module-evdev kernel-module-gpio-keys kernel-module-leds-gpio kernel-module-can-raw kernel-module-uvcvideo"
