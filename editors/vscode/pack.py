"""Write symflex.vsix from this folder, without network; ``code --install-extension`` installs it."""

import json
import sys
import zipfile
from pathlib import Path

FOLDER = Path(__file__).parent
FILES = ("package.json", "extension.js", "language-configuration.json", "symflex.tmLanguage.json")
TYPES = """<?xml version="1.0" encoding="utf-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
  <Default Extension=".json" ContentType="application/json"/>
  <Default Extension=".js" ContentType="application/javascript"/>
  <Default Extension=".vsixmanifest" ContentType="text/xml"/>
</Types>
"""
MANIFEST = """<?xml version="1.0" encoding="utf-8"?>
<PackageManifest Version="2.0.0" xmlns="http://schemas.microsoft.com/developer/vsx-schema/2011">
  <Metadata>
    <Identity Language="en-US" Id="{name}" Version="{version}" Publisher="{publisher}"/>
    <DisplayName>{displayName}</DisplayName>
    <Description xml:space="preserve">{description}</Description>
    <Properties><Property Id="Microsoft.VisualStudio.Code.Engine" Value="{engine}"/></Properties>
  </Metadata>
  <Installation><InstallationTarget Id="Microsoft.VisualStudio.Code"/></Installation>
  <Dependencies/>
  <Assets>
    <Asset Type="Microsoft.VisualStudio.Code.Manifest" Path="extension/package.json" Addressable="true"/>
  </Assets>
</PackageManifest>
"""


def pack(path: Path) -> None:
    """Write the extension as a package."""
    package = json.loads((FOLDER / "package.json").read_text(encoding="utf-8"))
    manifest = MANIFEST.format(**package, engine=package["engines"]["vscode"])
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("[Content_Types].xml", TYPES)
        archive.writestr("extension.vsixmanifest", manifest)
        for name in FILES:
            archive.write(FOLDER / name, f"extension/{name}")


if __name__ == "__main__":
    pack(Path(sys.argv[1] if len(sys.argv) > 1 else "symflex.vsix"))
