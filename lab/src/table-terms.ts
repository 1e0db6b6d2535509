// Explanations of the page's terms: Romanian, French, Portuguese, English. A key is `about` and the term.

export const TERMS = {
  "What is {0}?": ["Ce este {0}?", "Qu’est-ce que {0} ?", "O que é {0}?"],

  "Finished picture": ["Imaginea finită", "Image finie", "Imagem acabada"],
  "close a dialog or a menu, or leave the steps for the finished picture": [
    "închide un dialog sau un meniu, ori lasă pașii pentru imaginea finită",
    "fermer un dialogue ou un menu, ou quitter les étapes pour l’image finie",
    "fechar um diálogo ou um menu, ou deixar os passos pela imagem acabada",
  ],
  "Move aside": ["Mută alături", "Déplacer de côté", "Mover para o lado"],

  // Legends
  "pale: will be drawn over": ["palid: va fi acoperit", "pâle : sera recouvert", "pálido: será coberto"],
  "not decided yet": ["încă nedecis", "pas encore décidé", "ainda não decidido"],
  "nearer, is kept": ["mai aproape, se păstrează", "plus proche, gardé", "mais perto, fica"],
  "farther, is hidden": ["mai departe, ascuns", "plus loin, caché", "mais longe, escondido"],
  "Depths: 1 is near, 0 is far.": ["Adâncimi: 1 este aproape, 0 departe.", "Profondeurs : 1 est proche, 0 est loin.", "Profundidades: 1 é perto, 0 é longe."],
  "Windows are cut between tiles of 64 pixels, then at powers of two, never through a pixel.": [
    "Ferestrele se taie între dale de 64 de pixeli, apoi la puteri ale lui doi, niciodată printr-un pixel.",
    "Les fenêtres sont coupées entre carreaux de 64 pixels, puis aux puissances de deux, jamais dans un pixel.",
    "As janelas cortam-se entre blocos de 64 píxeis, depois em potências de dois, nunca por um píxel.",
  ],

  "cost from blue to red: opaque facets that cover the pixel": [
    "costul de la albastru la roșu: fațete opace care acoperă pixelul",
    "coût du bleu au rouge : facettes opaques qui couvrent le pixel",
    "custo do azul ao vermelho: facetas opacas que cobrem o píxel",
  ],
  "cost from blue to red: polygons that are in, over the spans of the pixel": [
    "costul de la albastru la roșu: poligoane active peste intervalele pixelului",
    "coût du bleu au rouge : polygones actifs sur les segments du pixel",
    "custo do azul ao vermelho: polígonos ativos sobre os intervalos do píxel",
  ],
  "cost from blue to red: boxes or cells and facets that the rays of its block of pixels were tested against": [
    "costul de la albastru la roșu: cutii sau celule și fațete testate de razele blocului de pixeli",
    "coût du bleu au rouge : boîtes ou cellules et facettes testées par les rayons du bloc de pixels",
    "custo do azul ao vermelho: caixas ou células e facetas testadas pelos raios do bloco de píxeis",
  ],
  "cost from blue to red: facets that the rays of its block of pixels were tested against": [
    "costul de la albastru la roșu: fațete testate de razele blocului de pixeli",
    "coût du bleu au rouge : facettes testées par les rayons du bloc de pixels",
    "custo do azul ao vermelho: facetas testadas pelos raios do bloco de píxeis",
  ],
  "outlines of windows: green one polygon, yellow surrounded, red one pixel, blue empty": [
    "contururi de ferestre: verde un poligon, galben înconjurată, roșu un pixel, albastru goală",
    "contours des fenêtres : vert un polygone, jaune entourée, rouge un pixel, bleu vide",
    "contornos das janelas: verde um polígono, amarelo rodeada, vermelho um píxel, azul vazia",
  ],
  "place in the list from blue (far) to red (near), outlines of polygons that were cut": [
    "locul în listă de la albastru (departe) la roșu (aproape), contururile poligoanelor tăiate",
    "place dans la liste du bleu (loin) au rouge (près), contours des polygones coupés",
    "lugar na lista do azul (longe) ao vermelho (perto), contornos dos polígonos cortados",
  ],
  "outlines of the visible polygons, blue": [
    "contururile poligoanelor vizibile, albastru",
    "contours des polygones visibles, bleu",
    "contornos dos polígonos visíveis, azul",
  ],

  // Comparison, curves, marks
  on: ["activ", "activé", "ativo"],
  off: ["inactiv", "désactivé", "inativo"],
  usual: ["obișnuit", "habituel", "habitual"],
  "of a picture after the first, which also builds what an algorithm keeps, such as trees": [
    "pentru o imagine; prima imagine a unui algoritm construiește și ce păstrează el, de exemplu arbori",
    "d’une image ; la première image d’un algorithme construit aussi ce qu’il garde, par exemple des arbres",
    "de uma imagem; a primeira imagem de um algoritmo constrói também o que ele guarda, como árvores",
  ],
  "what it keeps besides the picture; –: nothing": ["ce păstrează pe lângă imagine; –: nimic", "ce qu’il garde outre l’image ; – : rien", "o que guarda além da imagem; –: nada"],
  "from the first algorithm's picture; 0: all agree": ["față de imaginea primului algoritm; 0: toți sunt de acord", "de l’image du premier algorithme ; 0 : tous s’accordent", "da imagem do primeiro algoritmo; 0: todos concordam"],
  "what the algorithm counted; those that are 0 are left out": [
    "ce a numărat algoritmul; cele care sunt 0 lipsesc",
    "ce que l’algorithme a compté ; ceux qui valent 0 sont omis",
    "o que o algoritmo contou; os que são 0 não aparecem",
  ],
  solid: ["continuu", "continu", "contínuo"],
  dashed: ["întrerupt", "tireté", "tracejado"],
  "dotted: above 1, where it is clamped": ["punctat: peste 1, unde este limitat", "pointillé : au-dessus de 1, où c’est limité", "pontilhado: acima de 1, onde é limitado"],
  "centroid of the highlight of {0}": ["centrul reflexului luminii {0}", "centre du reflet de {0}", "centro do brilho de {0}"],
  "mirror point of {0}": ["punctul de oglindire al luminii {0}", "point de réflexion de {0}", "ponto de reflexão de {0}"],

  // Fields of area lights
  Shape: ["Formă", "Forme", "Forma"],
  Disc: ["Disc", "Disque", "Disco"],
  Rectangle: ["Dreptunghi", "Rectangle", "Retângulo"],
  Radius: ["Rază", "Rayon", "Raio"],
  Centre: ["Centru", "Centre", "Centro"],
  "Centre {0}": ["Centru {0}", "Centre {0}", "Centro {0}"],
  "Normal {0}": ["Normală {0}", "Normale {0}", "Normal {0}"],
  "Corner {0}": ["Colțul {0}", "Sommet {0}", "Canto {0}"],
  "Corner {0} {1}": ["Colțul {0} {1}", "Sommet {0} {1}", "Canto {0} {1}"],


  // Settings
  "about Model": [
    "Scena desenată: rețele de poligoane cu materiale, lumini și o cameră. Cele incluse sunt scenele cursului; un fișier propriu se deschide cu butonul de sus.",
    "La scène tracée : des maillages de polygones avec matériaux, lumières et caméra. Les modèles intégrés sont les scènes du cours ; le bouton du haut ouvre un fichier à vous.",
    "A cena desenhada: malhas de polígonos com materiais, luzes e uma câmara. Os modelos incluídos são as cenas do curso; o botão de cima abre um ficheiro seu.",
    "The scene that is drawn: meshes of polygons with materials, lights and a camera. The built-in ones are the course's scenes; the button above opens a file of yours.",
  ],
  "about Visibility": [
    "Algoritmul care decide ce suprafață se vede în fiecare pixel. Toți dau aceeași imagine: în spațiul obiect compară poligoane, în spațiul imagine eșantioane.",
    "L’algorithme qui décide quelle surface se voit en chaque pixel. Tous donnent la même image : dans l’espace objet ils comparent des polygones, dans l’espace image des échantillons.",
    "O algoritmo que decide que superfície se vê em cada píxel. Todos dão a mesma imagem: no espaço do objeto comparam polígonos, no espaço da imagem amostras.",
    "The algorithm that decides which surface is seen in each pixel. All give the same picture: in object space they compare polygons, in image space samples.",
  ],
  "about Acceleration": [
    "Structura care îi spune unei raze ce poligoane poate întâlni, ca să nu fie testate toate: o ierarhie de cutii, o grilă sau un volum în jurul fiecărui obiect.",
    "La structure qui dit à un rayon quels polygones il peut rencontrer, pour ne pas tous les tester : hiérarchie de boîtes, grille, ou volume autour de chaque objet.",
    "A estrutura que diz a um raio que polígonos pode encontrar, para não testar todos: uma hierarquia de caixas, uma grelha ou um volume à volta de cada objeto.",
    "The structure that tells a ray which polygons it may meet, so that not all are tested: a hierarchy of boxes, a grid, or a volume round each object.",
  ],
  "about Illumination": [
    "Formula care dă intensitatea luminii reflectate de un punct spre ochi, din lumini, material și normală: I = Ia·ka + suma pe lumini.",
    "La formule qui donne l’intensité qu’un point renvoie vers l’œil, à partir des lumières, du matériau et de la normale : I = Ia·ka + somme sur les lumières.",
    "A fórmula que dá a intensidade que um ponto reflete para o olho, a partir das luzes, do material e da normal: I = Ia·ka + soma sobre as luzes.",
    "The formula for the intensity that a point reflects towards the eye, from lights, material and normal: I = Ia·ka + a sum over the lights.",
  ],
  "about Shading": [
    "Unde se calculează formula de iluminare: o dată pe față (constantă), în vârfuri cu intensități interpolate (Gouraud) sau în fiecare pixel cu normale interpolate (Phong).",
    "Où la formule d’illumination est évaluée : une fois par face (plat), aux sommets avec intensités interpolées (Gouraud), ou en chaque pixel avec normales interpolées (Phong).",
    "Onde a fórmula de iluminação é avaliada: uma vez por face (plano), nos vértices com intensidades interpoladas (Gouraud) ou em cada píxel com normais interpoladas (Phong).",
    "Where the illumination formula is evaluated: once a face (flat), at vertices with interpolated intensities (Gouraud), or in each pixel with interpolated normals (Phong).",
  ],
  "about Interpolation": [
    "Cum trec valorile vârfurilor la pixeli: liniar pe ecran sau corect în perspectivă, împărțind la w. Cea liniară deformează texturile și intensitățile.",
    "Comment les valeurs des sommets passent aux pixels : linéairement à l’écran, ou justes en perspective par division par w. La forme linéaire déforme textures et intensités.",
    "Como os valores dos vértices passam aos píxeis: linearmente no ecrã, ou certos em perspetiva, dividindo por w. A linear deforma texturas e intensidades.",
    "How values of vertices get to the pixels: linearly on the screen, or right in perspective by dividing by w. The linear form distorts textures and intensities.",
  ],
  "about Shadows": [
    "Algoritmul care află ce puncte nu sunt atinse de o lumină. Punctele care văd lumina sunt luminate; pentru celelalte S este 0.",
    "L’algorithme qui trouve les points qu’une lumière n’atteint pas. Les points qui voient la lumière sont éclairés ; pour les autres, S vaut 0.",
    "O algoritmo que encontra os pontos que uma luz não alcança. Os pontos que veem a luz são iluminados; para os outros, S é 0.",
    "The algorithm that finds the points that a light does not reach. Points that see the light are lit; for the others S is 0.",
  ],
  "about Volume counting": [
    "Cum se numără fețele volumelor de umbră: de la ochi la suprafață (z-pass) sau dincolo de suprafață (z-fail), care merge și cu ochiul în umbră.",
    "Comment compter les faces des volumes d’ombre : de l’œil à la surface (z-pass), ou au-delà de la surface (z-fail), ce qui marche aussi quand l’œil est dans l’ombre.",
    "Como se contam as faces dos volumes de sombra: do olho até à superfície (z-pass), ou para lá da superfície (z-fail), que funciona também com o olho na sombra.",
    "How faces of shadow volumes are counted: from the eye to the surface (z-pass), or beyond the surface (z-fail), which works with the eye in shadow as well.",
  ],
  "about Transparency": [
    "Cum se amestecă o suprafață transparentă cu ce este în spate: liniar I = (1−kt)·I1 + kt·I2, cu kt după unghi (Kay), sau filtrând culoarea din spate.",
    "Comment une surface transparente se mêle à ce qui est derrière : linéairement I = (1−kt)·I1 + kt·I2, avec kt selon l’angle (Kay), ou en filtrant la couleur de derrière.",
    "Como uma superfície transparente se mistura com o que está atrás: linearmente I = (1−kt)·I1 + kt·I2, com kt segundo o ângulo (Kay), ou filtrando a cor de trás.",
    "How a transparent surface mixes with what is behind it: linearly I = (1−kt)·I1 + kt·I2, with a kt that depends on the angle (Kay), or by filtering the colour behind.",
  ],
  "about Transparency order": [
    "Amestecul depinde de ordine: straturile unui pixel trebuie combinate din spate în față. Se alege cum se obține ordinea; submission, ordinea scenei, arată eroarea clasică.",
    "Le mélange dépend de l’ordre : les couches d’un pixel se combinent d’arrière en avant. On choisit ici comment l’ordre s’obtient ; submission, l’ordre de la scène, montre l’erreur classique.",
    "A mistura depende da ordem: as camadas de um píxel combinam-se de trás para a frente. Escolhe-se como se obtém a ordem; submission, a ordem da cena, mostra o erro clássico.",
    "Mixing depends on order: the layers of a pixel are combined from back to front. This chooses how the order is found; submission, the scene's own order, shows the classical error.",
  ],
  "about Global illumination": [
    "Lumina care vine de la alte suprafețe: reflectată și refractată (ray-trace) sau difuză între suprafețe mate (radiosity). Fără ea contează doar luminile.",
    "La lumière qui vient d’autres surfaces : réfléchie et réfractée (ray-trace), ou diffuse entre surfaces mates (radiosity). Sans elle, seules les lumières comptent.",
    "A luz que vem de outras superfícies: refletida e refratada (ray-trace), ou difusa entre superfícies mate (radiosity). Sem ela só contam as luzes.",
    "Light that comes from other surfaces: mirrored and refracted (ray-trace), or diffuse between matt surfaces (radiosity). Without it only lights count.",
  ],
  "about Colour space": [
    "Cum devin intensitățile octeți: srgb le codifică pentru ecran, raw le scrie proporțional, cum făceau OpenGL din Lab3D și formulele cursului.",
    "Comment les intensités deviennent des octets : srgb les code pour l’écran, raw les écrit proportionnellement, comme l’OpenGL de Lab3D et les formules du cours.",
    "Como as intensidades se tornam bytes: srgb codifica-as para o ecrã, raw escreve-as em proporção, como o OpenGL do Lab3D e as fórmulas do curso.",
    "How intensities become bytes: srgb encodes them for the screen, raw writes them in proportion, as Lab3D's OpenGL and the course's formulas do.",
  ],
  "about Samples": [
    "În câte puncte este decis fiecare pixel. Media lor netezește muchiile (antialiasing); cu un singur eșantion muchiile sunt în trepte.",
    "Le nombre de points où chaque pixel est décidé. Leur moyenne lisse les bords (anticrénelage) ; avec un seul échantillon, les bords sont en escalier.",
    "Em quantos pontos cada píxel é decidido. A média suaviza as arestas (antialiasing); com uma só amostra as arestas ficam em degraus.",
    "How many points decide each pixel. Their mean smooths edges (antialiasing); with one sample edges are stairs.",
  ],
  "about Size": [
    "Lățimea și înălțimea imaginii în pixeli. Algoritmii din spațiul imagine costă mai mult într-o imagine mai mare; cei din spațiul obiect nu.",
    "Largeur et hauteur de l’image en pixels. Les algorithmes de l’espace image coûtent plus dans une image plus grande ; ceux de l’espace objet non.",
    "Largura e altura da imagem em píxeis. Os algoritmos do espaço da imagem custam mais numa imagem maior; os do espaço do objeto não.",
    "Width and height of the picture in pixels. Image-space algorithms cost more in a larger picture; object-space ones do not.",
  ],
  "about Depth bits": [
    "Precizia z-buffer-ului. Cu puțini biți, suprafețe apropiate primesc aceeași adâncime și se amestecă (z-fighting). Gol: numere în virgulă mobilă.",
    "La précision du tampon de profondeur. Avec peu de bits, des surfaces proches ont la même profondeur et se mêlent (z-fighting). Vide : nombres à virgule flottante.",
    "A precisão do z-buffer. Com poucos bits, superfícies próximas ficam com a mesma profundidade e misturam-se (z-fighting). Vazio: números de vírgula flutuante.",
    "Precision of the z-buffer. With few bits close surfaces get the same depth and mix (z-fighting). Empty: floating-point numbers.",
  ],
  "about Shadow map size": [
    "Latura, în texeli, a z-buffer-ului văzut din lumină. Prea mică, marginea umbrei este în trepte.",
    "Le côté, en texels, du tampon de profondeur vu de la lumière. Trop petit, le bord de l’ombre est en escalier.",
    "O lado, em texels, do z-buffer visto da luz. Se for pequeno demais, o bordo da sombra fica em degraus.",
    "Side, in texels, of the z-buffer seen from the light. Too small, and a shadow's edge is stairs.",
  ],
  "about Coherence": [
    "Ce este adevărat într-un loc rămâne adeseori adevărat alături. Algoritmii economisesc calcule folosind asta; fără ea imaginea este aceeași, contoarele cresc.",
    "Ce qui est vrai en un lieu l’est souvent à côté. Les algorithmes s’en servent pour calculer moins ; sans elle l’image est la même, les compteurs montent.",
    "O que é verdade num sítio é muitas vezes verdade ao lado. Os algoritmos poupam cálculos com isso; sem ela a imagem é a mesma e os contadores sobem.",
    "What is true in one place is often true beside it. Algorithms save work by that; without it the picture is the same and the counters rise.",
  ],
  "about Culling": [
    "Poligoane eliminate înaintea algoritmului: cele din afara volumului de vizualizare și fețele întoarse de la ochi (V·N < 0), pe care un corp închis le ascunde.",
    "Polygones ôtés avant l’algorithme : hors du volume de vision, et faces tournées à l’opposé de l’œil (V·N < 0), qu’un corps fermé cache.",
    "Polígonos retirados antes do algoritmo: fora do volume de visão, e faces viradas para longe do olho (V·N < 0), que um corpo fechado esconde.",
    "Polygons dropped before the algorithm: those outside the view volume, and faces turned away from the eye (V·N < 0), which a closed body hides.",
  ],
  "about View volume": [
    "Partea din univers pe care o vede ochiul: o piramidă retezată între planul din față și cel din spate.",
    "La part de l’univers que voit l’œil : une pyramide tronquée entre les plans avant et arrière.",
    "A parte do mundo que o olho vê: uma pirâmide truncada entre o plano da frente e o de trás.",
    "The part of the world that the eye sees: a pyramid cut off by the front and back planes.",
  ],
  "about Back faces": [
    "Fețe a căror normală arată de la ochi. La un corp închis cele din față le ascund mereu.",
    "Faces dont la normale s’écarte de l’œil. Dans un corps fermé, celles de devant les cachent toujours.",
    "Faces cuja normal aponta para longe do olho. Num corpo fechado as da frente escondem-nas sempre.",
    "Faces whose normal points away from the eye. In a closed body front faces always hide them.",
  ],
  "about Channels shown": [
    "Ce arată imaginea: culoarea sau datele din care se face, câte un canal. Culorile unui canal sunt explicate sub imagine.",
    "Ce que montre l’image : la couleur, ou les données dont elle est faite, un canal à la fois. Les couleurs d’un canal sont expliquées sous l’image.",
    "O que a imagem mostra: a cor, ou os dados de que é feita, um canal de cada vez. As cores de um canal são explicadas por baixo da imagem.",
    "What the picture shows: colour, or the data it is made of, one channel at a time. The colours of a channel are explained below the picture.",
  ],

  // Channels, which the line below the picture explains in the same words
  "about Colour": [
    "Imaginea finită.",
    "L’image finie.",
    "A imagem acabada.",
    "The finished picture.",
  ],
  "about Depth": [
    "Deschis: aproape, întunecat: departe (adâncimea este 1 aproape, 0 departe); negru: fundal.",
    "Clair : proche, sombre : loin (la profondeur vaut 1 tout près, 0 au loin) ; noir : fond.",
    "Claro: perto, escuro: longe (a profundidade é 1 perto, 0 longe); preto: fundo.",
    "Light: near, dark: far (depth is 1 near, 0 far); black: background.",
  ],
  "about Id": [
    "O culoare pentru fiecare suprafață, aleasă doar ca vecinele să se deosebească.",
    "Une couleur par surface, choisie seulement pour distinguer les voisines.",
    "Uma cor por superfície, escolhida só para distinguir as vizinhas.",
    "One colour for each surface, chosen only to tell neighbours apart.",
  ],
  "about Normal": [
    "Normala ca o culoare: roșu x, verde y, albastru z; gri mediu este 0, deschis +1, întunecat −1.",
    "La normale comme couleur : rouge x, vert y, bleu z ; le gris moyen est 0, clair +1, sombre −1.",
    "A normal como cor: vermelho x, verde y, azul z; o cinzento médio é 0, claro +1, escuro −1.",
    "The normal as a colour: red x, green y, blue z; middle grey is 0, light +1, dark −1.",
  ],
  "about Attached shadow": [
    "Umbra proprie: partea de lumini de la care suprafața este întoarsă (N·L < 0). Alb: toate, negru: niciuna.",
    "L’ombre propre : la part des lumières dont la surface se détourne (N·L < 0). Blanc : toutes, noir : aucune.",
    "A sombra própria: a parte das luzes para as quais a superfície está de costas (N·L < 0). Branco: todas, preto: nenhuma.",
    "Attached shadow: the share of lights that the surface faces away from (N·L < 0). White: all, black: none.",
  ],
  "about Cast shadow": [
    "Umbra purtată: partea de lumini pe care alte suprafețe le opresc. Alb: toate, negru: niciuna.",
    "L’ombre portée : la part des lumières que d’autres surfaces arrêtent. Blanc : toutes, noir : aucune.",
    "A sombra projetada: a parte das luzes que outras superfícies tapam. Branco: todas, preto: nenhuma.",
    "Cast shadow: the share of lights that other surfaces keep away. White: all, black: none.",
  ],
  "about Steps": [
    "Munca algoritmului de vizibilitate, peste imaginea în gri: ferestre, ordinea listei sau costul fiecărui pixel.",
    "Le travail de l’algorithme de visibilité, sur l’image en gris : fenêtres, ordre de la liste, ou coût de chaque pixel.",
    "O trabalho do algoritmo de visibilidade, sobre a imagem em cinzento: janelas, ordem da lista, ou custo de cada píxel.",
    "The work of the visibility algorithm over the picture in grey: windows, order of the list, or cost of each pixel.",
  ],
  "about Ambient term": [
    "Doar lumina din toate părțile: Ia·ka, aceeași în orice punct al unui material.",
    "Seulement la lumière de toutes parts : Ia·ka, la même en tout point d’un matériau.",
    "Só a luz de todos os lados: Ia·ka, a mesma em todos os pontos de um material.",
    "Only light from all sides: Ia·ka, the same at every point of a material.",
  ],
  "about Diffuse term": [
    "Doar reflexia difuză: Ip·kd·(N·L), aceeași din orice parte s-ar privi.",
    "Seulement la réflexion diffuse : Ip·kd·(N·L), la même d’où que l’on regarde.",
    "Só a reflexão difusa: Ip·kd·(N·L), a mesma de onde quer que se olhe.",
    "Only diffuse reflection: Ip·kd·(N·L), the same from wherever one looks.",
  ],
  "about Specular term": [
    "Doar reflexul: Ip·ks·(R·V)ⁿ, în jurul direcției de oglindire.",
    "Seulement le reflet : Ip·ks·(R·V)ⁿ, autour de la direction de réflexion.",
    "Só o brilho: Ip·ks·(R·V)ⁿ, à volta da direção de reflexão.",
    "Only the highlight: Ip·ks·(R·V)ⁿ, round the mirror direction.",
  ],

  // Lights
  "about Light Number": [
    "Lumina pe care o schimbă câmpurile de mai jos, numită ca în OpenGL: LIGHT0, LIGHT1, …",
    "La lumière que changent les champs ci-dessous, nommée comme dans OpenGL : LIGHT0, LIGHT1, …",
    "A luz que os campos abaixo mudam, chamada como no OpenGL: LIGHT0, LIGHT1, …",
    "The light that the fields below change, called as in OpenGL: LIGHT0, LIGHT1, …",
  ],
  "about Enabled": [
    "O lumină oprită nu contribuie cu nimic, nici cu partea ambiantă.",
    "Une lumière éteinte n’apporte rien, pas même sa part ambiante.",
    "Uma luz desligada não contribui com nada, nem com a parte ambiente.",
    "A light that is off adds nothing, not even its ambient part.",
  ],
  "about Kind": [
    "De unde vin razele: din toate părțile (ambiantă), paralele (direcțională), dintr-un punct, dintr-un punct în con (reflector) sau de pe o suprafață.",
    "D’où viennent les rayons : de toutes parts (ambiante), parallèles (directionnelle), d’un point, d’un point dans un cône (spot), ou d’une surface.",
    "De onde vêm os raios: de todos os lados (ambiente), paralelos (direcional), de um ponto, de um ponto num cone (foco), ou de uma superfície.",
    "Where the rays come from: all sides (ambient), parallel (directional), a point, a point into a cone (spot), or a surface (area).",
  ],
  "about Ambient": [
    "Partea luminii care vine din toate direcțiile și este înmulțită cu ka; nu depinde de poziție și nu face umbră.",
    "La part de la lumière qui vient de toutes les directions, multipliée par ka ; elle ne dépend pas du lieu et ne fait pas d’ombre.",
    "A parte da luz que vem de todas as direções, multiplicada por ka; não depende do lugar nem faz sombra.",
    "The part of the light that comes from all directions, multiplied by ka; it depends on no place and casts no shadow.",
  ],
  "about Diffuse": [
    "Partea reflectată egal în toate direcțiile, după legea lui Lambert: proporțională cu N·L și cu kd.",
    "La part réfléchie également en toutes directions, selon la loi de Lambert : proportionnelle à N·L et à kd.",
    "A parte refletida por igual em todas as direções, pela lei de Lambert: proporcional a N·L e a kd.",
    "The part that is reflected equally in all directions, by Lambert's law: in proportion to N·L and kd.",
  ],
  "about Specular": [
    "Partea oglindită, care face reflexul: ks·(R·V)ⁿ. Culoarea reflexului este de obicei cea a luminii.",
    "La part réfléchie comme par un miroir, qui fait le reflet : ks·(R·V)ⁿ. Le reflet a en général la couleur de la lumière.",
    "A parte refletida como num espelho, que faz o brilho: ks·(R·V)ⁿ. O brilho tem em geral a cor da luz.",
    "The mirrored part, which makes the highlight: ks·(R·V)ⁿ. A highlight usually has the light's colour.",
  ],
  "about Position": [
    "Locul omogen al luminii: cu w = 1 punctul (x, y, z), cu w = 0 o lumină la infinit în direcția (x, y, z).",
    "La place homogène de la lumière : avec w = 1 le point (x, y, z), avec w = 0 une lumière à l’infini dans la direction (x, y, z).",
    "O lugar homogéneo da luz: com w = 1 o ponto (x, y, z), com w = 0 uma luz no infinito na direção (x, y, z).",
    "The light's homogeneous place: with w = 1 the point (x, y, z), with w = 0 a light at infinity in direction (x, y, z).",
  ],
  "about Direction": [
    "Axa conului: încotro luminează reflectorul.",
    "L’axe du cône : la direction dans laquelle éclaire le spot.",
    "O eixo do cone: para onde o foco ilumina.",
    "Axis of the cone: the way a spot light shines.",
  ],
  "about Shape": [
    "Suprafața care luminează: un disc sau un poligon. Dimensiunea ei face penumbra.",
    "La surface qui éclaire : un disque ou un polygone. Sa taille fait la pénombre.",
    "A superfície que ilumina: um disco ou um polígono. O seu tamanho faz a penumbra.",
    "The surface that shines: a disc or a polygon. Its size makes the penumbra.",
  ],
  "about Cutoff": [
    "Semiunghiul conului în grade: în afara lui reflectorul nu luminează.",
    "Le demi-angle du cône en degrés : au-dehors, le spot n’éclaire pas.",
    "O semiângulo do cone em graus: fora dele o foco não ilumina.",
    "Half angle of the cone in degrees: outside of it a spot light does not shine.",
  ],
  "about Exponent": [
    "Cum scade lumina spre marginea conului: cosinusul unghiului față de axă la această putere. 0: constantă.",
    "Comment la lumière décroît vers le bord du cône : le cosinus de l’angle à l’axe, à cette puissance. 0 : constante.",
    "Como a luz diminui para o bordo do cone: o cosseno do ângulo ao eixo, a esta potência. 0: constante.",
    "How light falls off towards the rim of the cone: the cosine of the angle to the axis, to this power. 0: constant.",
  ],
  "about Attenuation": [
    "Slăbirea luminii cu distanța d: f_att = min(1, 1 / (c1 + c2·d + c3·d²)). Legea 1/d² singură se schimbă prea repede aproape și prea puțin departe.",
    "L’affaiblissement avec la distance d : f_att = min(1, 1 / (c1 + c2·d + c3·d²)). La loi 1/d² seule varie trop de près et trop peu de loin.",
    "O enfraquecimento com a distância d: f_att = min(1, 1 / (c1 + c2·d + c3·d²)). A lei 1/d² sozinha varia demais ao perto e de menos ao longe.",
    "Loss over the distance d: f_att = min(1, 1 / (c1 + c2·d + c3·d²)). The law 1/d² alone changes too much nearby and too little far away.",
  ],
  "about Casts shadow": [
    "Dacă pentru această lumină se calculează umbre. Trebuie ales și un algoritm în Setări, Umbre.",
    "Si l’on calcule des ombres pour cette lumière. Il faut aussi un algorithme dans Réglages, Ombres.",
    "Se se calculam sombras para esta luz. É preciso também um algoritmo em Definições, Sombras.",
    "Whether shadows are computed for this light. Settings, Shadows must have an algorithm as well.",
  ],

  // Materials
  "about Material": [
    "Cum reflectă și transmite lumina o suprafață: coeficienții formulei de iluminare. Mai multe fețe pot avea același material.",
    "Comment une surface réfléchit et transmet la lumière : les coefficients de la formule. Plusieurs faces peuvent avoir le même matériau.",
    "Como uma superfície reflete e transmite a luz: os coeficientes da fórmula. Várias faces podem ter o mesmo material.",
    "How a surface reflects and transmits light: the coefficients of the formula. Several faces may share a material.",
  ],
  "about ka": [
    "Coeficientul ambiant, 0 la 1 pe canal: partea de lumină ambiantă pe care o reflectă materialul.",
    "Le coefficient ambiant, 0 à 1 par canal : la part de lumière ambiante que réfléchit le matériau.",
    "O coeficiente ambiente, 0 a 1 por canal: a parte da luz ambiente que o material reflete.",
    "Ambient coefficient, 0 to 1 a channel: the share of ambient light that the material reflects.",
  ],
  "about kd": [
    "Coeficientul difuz: raportul dintre lumina reflectată difuz și cea incidentă, pe canal. Este culoarea materialului.",
    "Le coefficient diffus : rapport entre lumière réfléchie diffusément et lumière incidente, par canal. C’est la couleur du matériau.",
    "O coeficiente difuso: a razão entre a luz refletida difusamente e a incidente, por canal. É a cor do material.",
    "Diffuse coefficient: diffusely reflected light over incident light, a channel. It is the material's colour.",
  ],
  "about ks": [
    "Coeficientul specular: cât de puternic este reflexul. La plastic este alb, la metal are culoarea metalului.",
    "Le coefficient spéculaire : la force du reflet. Blanc pour le plastique, de la couleur du métal pour un métal.",
    "O coeficiente especular: a força do brilho. Branco no plástico, da cor do metal num metal.",
    "Specular coefficient: the strength of the highlight. White for plastic, the metal's colour for a metal.",
  ],
  "about Shininess": [
    "Exponentul n din (R·V)ⁿ: cu cât este mai mare, cu atât reflexul este mai mic și mai strălucitor.",
    "L’exposant n de (R·V)ⁿ : plus il est grand, plus le reflet est petit et vif.",
    "O expoente n de (R·V)ⁿ: quanto maior, mais pequeno e vivo é o brilho.",
    "The exponent n in (R·V)ⁿ: the larger, the smaller and sharper the highlight.",
  ],
  "about Metallic": [
    "Cât de mult se poartă suprafața ca un metal: fără reflexie difuză, cu reflex colorat.",
    "À quel point la surface se comporte comme un métal : sans réflexion diffuse, avec un reflet coloré.",
    "Quanto a superfície se comporta como metal: sem reflexão difusa, com brilho colorido.",
    "How much the surface behaves like a metal: no diffuse reflection, a coloured highlight.",
  ],
  "about Roughness": [
    "Cât de neregulate sunt microfațetele: 0 este oglindă, 1 mat.",
    "L’irrégularité des microfacettes : 0 est un miroir, 1 est mat.",
    "A irregularidade das microfacetas: 0 é um espelho, 1 é mate.",
    "How uneven the microfacets are: 0 is a mirror, 1 is matt.",
  ],
  "about Opacity": [
    "1 − kt: partea pe care suprafața o arată din ea însăși. 1 este opac, 0 nu se vede.",
    "1 − kt : la part que la surface montre d’elle-même. 1 est opaque, 0 invisible.",
    "1 − kt: a parte que a superfície mostra de si própria. 1 é opaco, 0 invisível.",
    "1 − kt: the share that the surface shows of itself. 1 is opaque, 0 is unseen.",
  ],
  "about kt min": [
    "Cea mai mică transmisie în modelul lui Kay, acolo unde suprafața se întoarce de la ochi: marginea sticlei curbate este mai închisă.",
    "La plus petite transmission du modèle de Kay, là où la surface se détourne de l’œil : le bord du verre courbe est plus sombre.",
    "A menor transmissão no modelo de Kay, onde a superfície se afasta do olho: o bordo do vidro curvo é mais escuro.",
    "The least transmission in Kay's model, where the surface turns away from the eye: the rim of curved glass is darker.",
  ],
  "about Index of refraction": [
    "De câte ori merge lumina mai încet decât în vid. Legea lui Snell: n1·sin i = n2·sin r; sticla are circa 1.5.",
    "Combien de fois la lumière va moins vite que dans le vide. Loi de Snell : n1·sin i = n2·sin r ; le verre a environ 1.5.",
    "Quantas vezes a luz é mais lenta do que no vácuo. Lei de Snell: n1·sin i = n2·sin r; o vidro tem cerca de 1.5.",
    "How many times slower light is than in vacuum. Snell's law: n1·sin i = n2·sin r; glass has about 1.5.",
  ],
  "about Mirror": [
    "Trimite mai departe raze în direcția de oglindire (unghiuri egale). Se vede cu Iluminare globală, ray-trace.",
    "Renvoie des rayons dans la direction de réflexion (angles égaux). Se voit avec Illumination globale, ray-trace.",
    "Envia raios na direção de reflexão (ângulos iguais). Vê-se com Iluminação global, ray-trace.",
    "Sends rays on in the mirror direction (equal angles). It shows with Global illumination, ray-trace.",
  ],
  "about Transmission": [
    "Transparent: razele trec drept și se vede clar. Translucid: sunt împrăștiate și ce este în spate apare neclar.",
    "Transparente : les rayons passent droit et l’on voit net. Translucide : ils sont dispersés et l’arrière est flou.",
    "Transparente: os raios passam a direito e vê-se nítido. Translúcido: são dispersos e o que está atrás fica desfocado.",
    "Transparent: rays pass straight and one sees clearly. Translucent: they are scattered and what is behind is blurred.",
  ],

  // Camera
  "about eyeU": [
    "Unghiurile de rotație ale ochiului în jurul axelor x, y, z, în grade (eyeU în Lab3D).",
    "Angles de rotation de l’œil autour des axes x, y, z, en degrés (eyeU dans Lab3D).",
    "Ângulos de rotação do olho à volta dos eixos x, y, z, em graus (eyeU no Lab3D).",
    "Angles by which the eye is rotated about the axes x, y, z, in degrees (Lab3D's eyeU).",
  ],
  "about eyeT": [
    "Locul ochiului în univers (eyeT în Lab3D): translația aplicată camerei.",
    "La place de l’œil dans l’univers (eyeT dans Lab3D) : la translation de la caméra.",
    "O lugar do olho no mundo (eyeT no Lab3D): a translação da câmara.",
    "Place of the eye in the world (Lab3D's eyeT): the camera's translation.",
  ],
  "about allU": [
    "Unghiurile cu care se rotesc toate obiectele, în grade (allU în Lab3D). Luminile rămân pe loc.",
    "Angles dont tournent tous les objets, en degrés (allU dans Lab3D). Les lumières restent en place.",
    "Ângulos de que rodam todos os objetos, em graus (allU no Lab3D). As luzes ficam no lugar.",
    "Angles by which all objects are rotated, in degrees (Lab3D's allU). Lights stay in place.",
  ],
  "about allT": [
    "Translația tuturor obiectelor (allT în Lab3D). Luminile rămân pe loc.",
    "La translation de tous les objets (allT dans Lab3D). Les lumières restent en place.",
    "A translação de todos os objetos (allT no Lab3D). As luzes ficam no lugar.",
    "Translation of all objects (Lab3D's allT). Lights stay in place.",
  ],
  "about View angle": [
    "Deschiderea verticală a volumului de vizualizare, în grade. Mic: ca un teleobiectiv; mare: perspectivă puternică.",
    "L’ouverture verticale du volume de vision, en degrés. Petit : comme un téléobjectif ; grand : perspective forte.",
    "A abertura vertical do volume de visão, em graus. Pequeno: como uma teleobjetiva; grande: perspetiva forte.",
    "Vertical opening of the view volume in degrees. Small: like a telephoto lens; large: strong perspective.",
  ],
  "about Parallel": [
    "Proiecție paralelă: proiectorii nu se întâlnesc în ochi, iar depărtarea nu micșorează.",
    "Projection parallèle : les projecteurs ne se rencontrent pas dans l’œil, et l’éloignement ne rapetisse pas.",
    "Projeção paralela: os projetores não se encontram no olho, e a distância não diminui.",
    "Parallel projection: projectors do not meet in the eye, and distance does not make smaller.",
  ],

  // Words of counters and formulas
  "about facet": [
    "O față a scenei așa cum o primește algoritmul: după eliminare și decupare, numerotată.",
    "Une face de la scène telle que l’algorithme la reçoit : après élimination et découpage, numérotée.",
    "Uma face da cena como o algoritmo a recebe: depois do descarte e do recorte, numerada.",
    "A face of the scene as the algorithm gets it: after culling and clipping, numbered.",
  ],
  "about polygon": [
    "O linie închisă de vârfuri într-un plan. Pictorul și BSP pot tăia un poligon în mai multe.",
    "Une ligne fermée de sommets dans un plan. Le peintre et le BSP peuvent couper un polygone en plusieurs.",
    "Uma linha fechada de vértices num plano. O pintor e o BSP podem cortar um polígono em vários.",
    "A closed line of vertices in a plane. Painter's algorithm and BSP may cut one polygon into several.",
  ],
  "about surface": [
    "O față a modelului cu numărul ei în scenă; canalul Identificator arată aceste numere.",
    "Une face du modèle avec son numéro dans la scène ; le canal Identifiant montre ces numéros.",
    "Uma face do modelo com o seu número na cena; o canal Identificador mostra estes números.",
    "A face of the model with its number in the scene; the channel Id shows these numbers.",
  ],
  "about N·L": [
    "Cosinusul unghiului dintre normală și direcția spre lumină. Negativ: lumina este în spatele suprafeței.",
    "Le cosinus de l’angle entre la normale et la direction de la lumière. Négatif : la lumière est derrière la surface.",
    "O cosseno do ângulo entre a normal e a direção da luz. Negativo: a luz está atrás da superfície.",
    "Cosine of the angle between the normal and the direction to the light. Negative: the light is behind the surface.",
  ],
  "about R·V": [
    "Cosinusul unghiului Ω dintre direcția de oglindire R = 2N(N·L) − L și direcția spre ochi V.",
    "Le cosinus de l’angle Ω entre la direction de réflexion R = 2N(N·L) − L et la direction de l’œil V.",
    "O cosseno do ângulo Ω entre a direção de reflexão R = 2N(N·L) − L e a direção do olho V.",
    "Cosine of the angle Ω between the mirror direction R = 2N(N·L) − L and the direction to the eye V.",
  ],
  "about N·H": [
    "Cosinusul unghiului dintre normală și vectorul median H, între L și V (Blinn). Este mai ieftin decât R·V.",
    "Le cosinus de l’angle entre la normale et le vecteur médian H, entre L et V (Blinn). Moins cher que R·V.",
    "O cosseno do ângulo entre a normal e o vetor médio H, entre L e V (Blinn). Mais barato do que R·V.",
    "Cosine of the angle between the normal and the halfway vector H of L and V (Blinn). Cheaper than R·V.",
  ],
  "about f_att": [
    "Factorul de atenuare al luminii la distanța ei: 1 fără pierdere, spre 0 departe.",
    "Le facteur d’atténuation de la lumière à sa distance : 1 sans perte, vers 0 au loin.",
    "O fator de atenuação da luz à sua distância: 1 sem perda, para 0 ao longe.",
    "Attenuation factor of the light at its distance: 1 without loss, towards 0 far away.",
  ],
  "about S": [
    "Umbra: 1 dacă lumina ajunge în punct, 0 dacă este oprită, între ele în penumbră sau prin sticlă.",
    "L’ombre : 1 si la lumière atteint le point, 0 si elle est arrêtée, entre les deux en pénombre ou à travers du verre.",
    "A sombra: 1 se a luz chega ao ponto, 0 se é tapada, entre ambos na penumbra ou através de vidro.",
    "Shadow: 1 if the light reaches the point, 0 if it is kept away, between them in penumbra or through glass.",
  ],

  // Links, settings and handles
  "Only {0} sort polygons back to front": [
    "Doar {0} sortează poligoanele din spate în față",
    "Seuls {0} trient les polygones d’arrière en avant",
    "Só {0} ordenam os polígonos de trás para a frente",
  ],
  "Only a shadow algorithm finds cast shadows": [
    "Doar un algoritm de umbre găsește umbrele purtate",
    "Seul un algorithme d’ombres trouve les ombres portées",
    "Só um algoritmo de sombras encontra as sombras projetadas",
  ],
  "outside of the picture": ["în afara imaginii", "hors de l’image", "fora da imagem"],
} as const satisfies Record<string, readonly [string, string, string, string?]>;
