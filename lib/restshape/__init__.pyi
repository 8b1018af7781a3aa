"""What `import restshape` offers; each name is imported where it is first used."""

from restshape.errors import UserError as UserError
from restshape.interface.hand import Hand as Hand
from restshape.interface.opened_recording import FrameOnFile as FrameOnFile
from restshape.interface.opened_recording import OpenedRecording as OpenedRecording
from restshape.interface.opened_recording import recording as recording
from restshape.interface.replays import replay as replay
from restshape.interface.run import Run as Run
from restshape.interface.scenes import changed as changed
from restshape.interface.scenes import load as load
from restshape.interface.scenes import new_scene as new_scene
from restshape.interface.scenes import save_scene as save_scene
from restshape.interface.scripts import load_script as load_script
from restshape.interface.scripts import new_script as new_script
from restshape.interface.scripts import save_script as save_script
from restshape.interface.shown_frame import ShownFrame as ShownFrame
from restshape.interface.shown_frame import ShownMesh as ShownMesh
from restshape.interface.simulation import RefusedFrame as RefusedFrame
from restshape.interface.simulation import Simulation as Simulation
from restshape.interface.simulation import open as open
from restshape.live.notebook import LivePage as LivePage
from restshape.live.notebook import live as live
from restshape.scene.edit_script import Script as Script
from restshape.scene.model import Scene as Scene

__version__: str
